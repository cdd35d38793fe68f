#pragma once
#include "engine/measure/compare.h"

namespace etalon {

/// The test of compare(): both films have variance, at least two samples and the same shape; pixels that are not finite
/// on either side are left out.
StatisticalTest welch_test(const Film& a, const Film& b, const CompareSettings& settings);

}  // namespace etalon
