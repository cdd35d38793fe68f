#pragma once
#include "tools/etalon/options.h"

namespace etalon::cli {

using Rows = std::vector<Option>;

// The options that several commands share, by heading of the help.
const Rows& view_rows();
const Rows& animation_rows();
const Rows& frame_rows();  ///< several pictures of an animation
const Rows& light_rows();
const Rows& shading_rows();
const Rows& sampling_rows();  ///< the knob table and the seed
const Rows& part_rows();
const Rows& develop_rows();
const Rows& post_rows();  ///< what is done to a film before it is developed
const Rows& device_rows();
const Rows& load_rows();
const Rows& json_rows();
const Rows& progress_rows();
const Rows& help_rows();

}  // namespace etalon::cli
