#include "engine/image/film_state.h"

#include <fmt/format.h>

#include <cstring>
#include <span>

#include "engine/base/digest.h"
#include "engine/base/error.h"
#include "engine/base/files.h"

namespace etalon {
namespace {

// The first bytes of every such file; the number is the format's.
constexpr std::string_view kMagic = "ETALON FILM STATE 1\n";

class Writer {
 public:
    void put(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
    void put(std::uint64_t value) { put(std::as_bytes(std::span(&value, 1))); }
    void put(const std::string& text)
    {
        put(text.size());
        put(std::as_bytes(std::span(text)));
    }
    template <typename T>
    void put_list(const std::vector<T>& values)
    {
        put(values.size());
        put(std::as_bytes(std::span(values)));
    }
    std::vector<std::byte> sealed() &&
    {
        Digest digest;
        digest.add(std::span<const std::byte>(bytes_));
        put(digest.value());
        return std::move(bytes_);
    }

 private:
    std::vector<std::byte> bytes_;
};

/// Reads what a Writer wrote. The checksum holds before anything is read, so that what fails here is a film state of a
/// kind that this program never wrote.
class Reader {
 public:
    explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

    std::span<const std::byte> take(std::uint64_t count)
    {
        if (count > rest_.size()) throw Error(Blame::input, "it ends too early");
        const auto out = rest_.first(count);
        rest_ = rest_.subspan(count);
        return out;
    }
    std::uint64_t number()
    {
        std::uint64_t value = 0;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    std::string text()
    {
        const auto bytes = take(number());
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    template <typename T>
    std::vector<T> list()
    {
        const std::uint64_t count = number();
        if (count > rest_.size() / sizeof(T)) throw Error(Blame::input, "it ends too early");
        const auto bytes = take(count * sizeof(T));
        std::vector<T> values(count);
        if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
        return values;
    }
    bool empty() const { return rest_.empty(); }

 private:
    std::span<const std::byte> rest_;
};

FilmState parse(std::span<const std::byte> bytes)
{
    const std::size_t seal = sizeof(std::uint64_t);
    if (bytes.size() < kMagic.size() + seal || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0)
        throw Error(Blame::input, "it is no film state", "a film state is what --resume wrote before");
    Digest digest;
    digest.add(bytes.first(bytes.size() - seal));
    std::uint64_t sealed = 0;
    std::memcpy(&sealed, bytes.last(seal).data(), seal);
    if (digest.value() != sealed)
        throw Error(Blame::input, "it is damaged: its checksum does not match", "remove it and begin anew");
    Reader in(bytes.first(bytes.size() - seal).subspan(kMagic.size()));
    FilmState state;
    for (std::uint64_t left = in.number(); left > 0; --left) {
        std::string name = in.text();
        state.of[std::move(name)] = in.text();
    }
    state.width = static_cast<int>(in.number());
    state.height = static_cast<int>(in.number());
    state.samples = in.number();
    state.nonfinite = in.number();
    state.truncated = in.number();
    state.sums = in.list<double>();
    state.block_samples = static_cast<std::uint32_t>(in.number());
    state.block = in.list<float>();
    if (!in.empty()) throw Error(Blame::input, "it has more than a film state has");
    return state;
}

}  // namespace

void write_film_state(const FilmState& state, const std::filesystem::path& path)
{
    Writer out;
    out.put(std::as_bytes(std::span(kMagic)));
    out.put(state.of.size());
    for (const auto& [name, value] : state.of) {
        out.put(name);
        out.put(value);
    }
    out.put(static_cast<std::uint64_t>(state.width));
    out.put(static_cast<std::uint64_t>(state.height));
    out.put(state.samples);
    out.put(state.nonfinite);
    out.put(state.truncated);
    out.put_list(state.sums);
    out.put(std::uint64_t{state.block_samples});
    out.put_list(state.block);
    const std::vector<std::byte> bytes = std::move(out).sealed();
    replace_file(path, std::span<const std::byte>(bytes));
}

FilmState read_film_state(const std::filesystem::path& path)
{
    const std::vector<std::byte> bytes = read_file(path, std::size_t{1} << 38);
    try {
        return parse(bytes);
    } catch (Error& error) {
        error.at(fmt::format("reading {}", path.string()));
        throw;
    }
}

std::string difference(const FilmState& there, const std::map<std::string, std::string>& here)
{
    for (const auto& [name, value] : here) {
        const auto found = there.of.find(name);
        if (found == there.of.end()) return fmt::format("{} is missing there", name);
        if (found->second != value) return fmt::format("{} is {} there and {} here", name, found->second, value);
    }
    for (const auto& [name, value] : there.of)
        if (!here.contains(name)) return fmt::format("{} is {} there and nothing here", name, value);
    return {};
}

void check_samples(const Checkpoints& checkpoints, std::uint64_t spp)
{
    if (checkpoints.from == nullptr || checkpoints.from->samples <= spp) return;
    throw Error(Blame::input,
                fmt::format("the film has {} samples a pixel already, more than the {} that are asked for",
                            checkpoints.from->samples, spp),
                "ask for more of them, or begin anew");
}

}  // namespace etalon
