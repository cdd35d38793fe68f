#pragma once
#include <optional>
#include <string>

#include "engine/image/film_state.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"
#include "tools/etalon/arguments.h"

namespace etalon::cli {

/// --shard: "2/3"; the whole picture when absent.
Shard shard(const Arguments& arguments);

/// What --resume and --checkpoint say.
struct Resume {
    std::string pattern;  ///< of the files of states, as those of outputs
    double seconds = 60;
};
/// Nothing without --resume. Error(input) where the settings have no samples to go on with.
std::optional<Resume> resume(const Arguments& arguments, const RenderSettings& settings);

/// The film state in a file while a picture is made from it: taken up where the file is there, written as it grows.
class StateFile {
 public:
    /// Error(input) when the file is damaged, or of another picture than of `posed` by these settings on `device`.
    StateFile(std::string path, double seconds, const PosedScene& posed, const RenderSettings& settings,
              const std::string& device);

    /// Refers to this.
    Checkpoints checkpoints();
    /// Samples a pixel that the file had.
    std::uint64_t begun() const { return state_ ? state_->samples : 0; }

 private:
    std::string path_;
    double seconds_;
    std::map<std::string, std::string> of_;
    std::optional<FilmState> state_;
};

}  // namespace etalon::cli
