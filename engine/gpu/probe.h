#pragma once
#include <chrono>
#include <string>

#include "engine/gpu/device.h"

namespace etalon::gpu {

/// Whether a device does what it promises.
struct ProbeResult {
    bool works = false;
    double milliseconds = 0;  ///< from first call to the picture read back
    std::string detail;       ///< "drew 2016 of 4096 pixels as expected", or what went wrong
};

/// Draws a triangle of known pixels, runs a compute kernel over it, reads both back and compares. Device errors and
/// `limit`, the most that is waited for the device's work, become `detail`; never throws Error.
ProbeResult probe(Device& device, std::chrono::milliseconds limit = std::chrono::seconds(10));

}  // namespace etalon::gpu
