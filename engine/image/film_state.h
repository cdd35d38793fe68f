#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace etalon {

/// Where the making of a film stands after some whole passes, to the last bit: what a renderer needs to go on as if it
/// had never stopped. The numbers are the renderer's own affair.
struct FilmState {
    /// Of what picture: everything that decides its bits but the number of samples.
    std::map<std::string, std::string> of;
    int width = 0;  ///< pixels of the film
    int height = 0;
    std::uint64_t samples = 0;  ///< per pixel
    std::uint64_t nonfinite = 0;
    std::uint64_t truncated = 0;
    std::vector<double> sums;
    std::uint32_t block_samples = 0;  ///< of `samples`, those that `block` has and `sums` lacks
    std::vector<float> block;
};

/// Replaces the file at once; a checksum goes with it. Error(input) where it cannot be written.
void write_film_state(const FilmState& state, const std::filesystem::path& path);
/// What write_film_state wrote. Error(input) where it is another file, damaged, or cut short.
FilmState read_film_state(const std::filesystem::path& path);

/// What differs between the pictures that two states are of: "max-depth is 4 there and 8 here"; empty when nothing.
std::string difference(const FilmState& there, const std::map<std::string, std::string>& here);

/// How a path tracer takes up a film and hands out states of it.
struct Checkpoints {
    const FilmState* from = nullptr;               ///< goes on from here; null: from nothing
    std::function<void(const FilmState&)> keep{};  ///< gets states (`of` left empty); null: nobody asks
    double seconds = 60;                           ///< from one to the next; the last is at the end
};
/// Error(input) when the state that is to be taken up has more than `spp` samples a pixel.
void check_samples(const Checkpoints& checkpoints, std::uint64_t spp);

}  // namespace etalon
