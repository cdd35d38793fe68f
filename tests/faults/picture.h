#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/scene/requirements.h"

namespace etalon::test {

/// A small picture to be disturbed: posed and required once, rendered often.
class Picture {
 public:
    Picture(const std::string& builtin, Renderer renderer, int side = 64, std::uint64_t spp = 2);
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    /// `device` is for the renderers that need one; made by them all the same way.
    Film render(gpu::Device* device) const;
    const RenderSettings& settings() const { return settings_; }

 private:
    Scene scene_;
    PosedScene posed_;
    RenderSettings settings_;
    Requirements required_;
};

/// How an attempt ended, as `main` would tell it.
struct Outcome {
    std::optional<Blame> blame;  ///< nothing: it succeeded
    std::string message;
    bool out_of_memory = false;  ///< std::bad_alloc reached the top, where it becomes "out of memory", exit code 3
};
Outcome attempt(const std::function<void()>& action);

bool same_bits(const Film& a, const Film& b);

/// Which of `count` faults a test tries: every one where ETALON_FAULTS=every, else about `few`: the first and last, and
/// ever rarer ones between, at random with a fixed seed.
std::vector<std::size_t> faults_to_try(std::size_t count, std::size_t few);
bool every_fault();

}  // namespace etalon::test
