#include "engine/image/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <span>
#include <utility>

#include "engine/base/digest.h"
#include "engine/base/error.h"

namespace etalon {
namespace {

constexpr const char* kShard = "shard";      // "2/3"
constexpr const char* kRows = "shard.rows";  // "160/480": the first row, and how many the picture has
constexpr const char* kScene = "shard.scene";
constexpr const char* kCheck = "shard.check";

/// visit(list of one value a pixel) for all of them.
template <typename SomeAovs, typename Visit>
void for_each_aov(SomeAovs& aovs, const Visit& visit)
{
    visit(aovs.depth);
    visit(aovs.normal);
    visit(aovs.albedo);
    visit(aovs.emission);
    visit(aovs.object_id);
    visit(aovs.material_id);
    visit(aovs.uv);
}
template <typename SomeFilm, typename Visit>
void for_each_list(SomeFilm& film, const Visit& visit)
{
    visit(film.mean);
    visit(film.variance);
    visit(film.alpha);
    visit(film.counts);
    for_each_aov(film.aovs, visit);
}

std::string checksum(const Film& film)
{
    Digest digest;
    digest.add(film.width);
    digest.add(film.height);
    digest.add(film.samples);
    digest.add(film.replicates);
    digest.add(film.nonfinite);
    digest.add(film.truncated);
    for_each_list(film, [&](const auto& list) { digest.add(std::as_bytes(std::span(list))); });
    for (const auto& [name, value] : film.metadata) {
        if (name == kCheck || name == "samples") continue;  // counts are members of a film that was read
        digest.add(std::string_view(name));
        digest.add(std::string_view(value));
    }
    return digest.text();
}

/// "160/480" as two numbers; 0 and 0 where it is something else.
std::pair<unsigned, unsigned> parse_pair(const std::string& text)
{
    const char* const end = text.data() + text.size();
    unsigned a = 0, b = 0;
    const auto [slash, fault] = std::from_chars(text.data(), end, a);
    if (fault != std::errc() || slash == end || *slash != '/') return {};
    const auto [rest, other_fault] = std::from_chars(slash + 1, end, b);
    if (other_fault != std::errc() || rest != end) return {};
    return {a, b};
}

struct Part {
    NamedFilm* file = nullptr;
    ShardPlace place;
};

Part part_of(NamedFilm& file)
{
    const auto& data = file.film.metadata;
    if (!data.contains(kShard))
        throw Error(Blame::input, fmt::format("{} is no shard", file.name),
                    "shards are what render --shard I/N writes");
    const auto check = data.find(kCheck);
    if (check == data.end() || check->second != checksum(file.film))
        throw Error(Blame::input, fmt::format("{} is damaged: its checksum does not match", file.name),
                    fmt::format("render shard {} again", data.at(kShard)));
    // What the checksum vouches for is what mark_shard wrote; all else is a forgery, but must do no harm.
    const auto value = [&](const char* name) { return data.contains(name) ? data.at(name) : std::string(); };
    const auto [number, count] = parse_pair(value(kShard));
    const auto [first_row, picture_height] = parse_pair(value(kRows));
    if (number < 1 || number > count || picture_height > 1u << 24 ||
        first_row + std::uint64_t(file.film.height) > picture_height)
        throw Error(Blame::input, fmt::format("{} says nothing sensible of what part it is", file.name));
    return {&file,
            {.number = number,
             .count = count,
             .first_row = int(first_row),
             .picture_height = int(picture_height),
             .scene = value(kScene)}};
}

/// Metadata that each shard has its own of.
bool is_own(const std::string& name)
{
    return name == kShard || name == kRows || name == kCheck || name == "error";
}

/// Throws where two shards are not of one picture.
void check_alike(const Part& a, const Part& b)
{
    const auto refuse = [&](const std::string& what, const std::string& here, const std::string& there) {
        throw Error(Blame::input,
                    fmt::format("{} and {} are not parts of one picture: {} is \"{}\" and \"{}\"", a.file->name,
                                b.file->name, what, here, there),
                    "render all shards with the same program, scene and settings");
    };
    const Film& left = a.file->film;
    const Film& right = b.file->film;
    const auto number = [](auto value) { return fmt::format("{}", value); };
    if (left.samples != right.samples) refuse("samples", number(left.samples), number(right.samples));
    if (left.replicates != right.replicates)
        refuse("number of replicates", number(left.replicates), number(right.replicates));
    if (left.width != right.width) refuse("width", number(left.width), number(right.width));
    if (a.place.picture_height != b.place.picture_height)
        refuse("height", number(a.place.picture_height), number(b.place.picture_height));
    if (a.place.count != b.place.count) refuse("number of shards", number(a.place.count), number(b.place.count));
    std::map<std::string, std::string> all = left.metadata;
    all.insert(right.metadata.begin(), right.metadata.end());
    for (const auto& [name, value] : all) {
        const auto in_left = left.metadata.find(name), in_right = right.metadata.find(name);
        const std::string here = in_left == left.metadata.end() ? "" : in_left->second;
        const std::string there = in_right == right.metadata.end() ? "" : in_right->second;
        if (!is_own(name) && here != there) refuse(name, here, there);
    }
    bool same_lists = true;
    std::vector<bool> has;
    for_each_list(left, [&](const auto& list) { has.push_back(list.empty()); });
    std::size_t i = 0;
    for_each_list(right, [&](const auto& list) { same_lists = same_lists && has[i++] == list.empty(); });
    if (!same_lists) refuse("what is recorded of a pixel", "one thing", "another");
}

/// In order, each once and none missing.
void check_complete(const std::vector<Part>& parts)
{
    const unsigned count = parts.front().place.count;
    for (std::size_t i = 1; i < parts.size(); ++i)
        if (parts[i].place.number == parts[i - 1].place.number)
            throw Error(Blame::input,
                        fmt::format("{} and {} are both shard {}/{}", parts[i - 1].file->name, parts[i].file->name,
                                    parts[i].place.number, count),
                        "leave one of them out");
    std::string missing;
    std::size_t given = 0;
    unsigned named = 0;
    for (unsigned number = 1; number <= count && named < 10; ++number) {
        if (given < parts.size() && parts[given].place.number == number) {
            ++given;
            continue;
        }
        missing += fmt::format("{}{}/{}", missing.empty() ? "" : ", ", number, count);
        ++named;
    }
    if (named > 0)
        throw Error(Blame::input,
                    fmt::format("{} of {} shards are missing: {}{}", count - parts.size(), count, missing,
                                count - parts.size() > named ? ", ..." : ""),
                    "render them, with the same settings");
    int row = 0;
    for (const Part& part : parts) {
        if (part.place.first_row != row)
            throw Error(Blame::input, fmt::format("{} begins at row {}, where row {} is due", part.file->name,
                                                  part.place.first_row, row));
        row += part.file->film.height;
    }
    if (row != parts.front().place.picture_height)
        throw Error(Blame::input,
                    fmt::format("the shards have {} rows of {}", row, parts.front().place.picture_height));
}

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& more)
{
    to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

Aovs rows_of(const Aovs& aovs, int first_row, int end_row, int width)
{
    const std::ptrdiff_t first = std::ptrdiff_t{first_row} * width, end = std::ptrdiff_t{end_row} * width;
    Aovs out = aovs;
    for_each_aov(out, [&](auto& list) {
        if (list.empty()) return;
        assume(static_cast<std::ptrdiff_t>(list.size()) >= end && first <= end);
        list.erase(list.begin() + end, list.end());
        list.erase(list.begin(), list.begin() + first);
    });
    return out;
}

void mark_shard(Film& film, const ShardPlace& place)
{
    film.metadata[kShard] = fmt::format("{}/{}", place.number, place.count);
    film.metadata[kRows] = fmt::format("{}/{}", place.first_row, place.picture_height);
    film.metadata[kScene] = place.scene;
    film.metadata[kCheck] = checksum(film);
}

Film merge_shards(std::vector<NamedFilm> shards)
{
    if (shards.empty()) throw Error(Blame::input, "nothing to merge");
    std::vector<Part> parts;
    for (NamedFilm& file : shards) parts.push_back(part_of(file));
    for (const Part& part : parts) check_alike(parts.front(), part);
    std::ranges::sort(parts, {}, [](const Part& part) { return part.place.number; });
    check_complete(parts);

    Film out = std::move(parts.front().file->film);
    for (const Part& part : std::span(parts).subspan(1)) {
        const Film& film = part.file->film;
        append(out.mean, film.mean);
        append(out.variance, film.variance);
        append(out.alpha, film.alpha);
        append(out.aovs.depth, film.aovs.depth);
        append(out.aovs.normal, film.aovs.normal);
        append(out.aovs.albedo, film.aovs.albedo);
        append(out.aovs.emission, film.aovs.emission);
        append(out.aovs.object_id, film.aovs.object_id);
        append(out.aovs.material_id, film.aovs.material_id);
        append(out.aovs.uv, film.aovs.uv);
        out.nonfinite += film.nonfinite;
        out.truncated += film.truncated;
    }
    out.height = parts.front().place.picture_height;
    for (const char* name : {kShard, kRows, kScene, kCheck, "error"}) out.metadata.erase(name);
    return out;
}

}  // namespace etalon
