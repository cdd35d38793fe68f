#pragma once
#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/image/post.h"

namespace etalon {

/// Applies post passes to a film on a device: (IP-1) to (IP-15). Film::variance is scaled along, or dropped where the
/// picture is no longer an estimate of radiance (PostError); AOVs stay. Film::metadata gets "post", and
/// "milliseconds.post NAME" of each pass. Throws Error(input) as plan_post does, and Error(machine) for a picture
/// larger than the device's images.
Film apply_post(gpu::Device& device, Film film, const PostChain& chain);

}  // namespace etalon
