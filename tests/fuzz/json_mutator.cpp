// Structure-aware mutation of glTF: edits one value, member or element of the JSON where it stands, the binary chunk,
// or the words of a GLB, and puts the lengths of the chunks right again (mostly). Compiled without sanitizers.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed);
extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* data1, std::size_t size1,
                                                 const std::uint8_t* data2, std::size_t size2, std::uint8_t* out,
                                                 std::size_t max_out_size, unsigned int seed);

namespace {

constexpr std::string_view kDictionary[] = {
#include "gltf_dict.inc"
};
constexpr std::size_t kRawShare = 8;  // one mutation in so many is libFuzzer's own

using Random = std::minstd_rand;

std::size_t below(Random& random, std::size_t n)
{
    return n == 0 ? 0 : random() % n;
}

// A value in JSON text. `entry` is where its member begins, at the key, or `begin` for an element.
struct Value {
    std::size_t entry;
    std::size_t begin;
    std::size_t end;
};

bool is_space(char c)
{
    return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}

std::size_t string_end(std::string_view text, std::size_t i)
{
    for (++i; i < text.size() && text[i] != '"'; ++i)
        if (text[i] == '\\') ++i;
    return std::min(i + 1, text.size());
}

std::size_t bare_end(std::string_view text, std::size_t i)
{
    while (i < text.size() && !is_space(text[i]) &&
           std::string_view(",:[]{}\"").find(text[i]) == std::string_view::npos)
        ++i;
    return i;
}

// Every value, outer before inner where brackets match; text that is no JSON gives what can be made out.
std::vector<Value> values_of(std::string_view text)
{
    std::vector<Value> out;
    std::vector<std::size_t> open;
    std::optional<std::size_t> key;
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        if (is_space(c) || c == ',' || c == ':') {
            ++i;
        } else if (c == '{' || c == '[') {
            open.push_back(out.size());
            out.push_back({key.value_or(i), i, text.size()});
            key.reset();
            ++i;
        } else if (c == '}' || c == ']') {
            ++i;
            if (!open.empty()) {
                out[open.back()].end = i;
                open.pop_back();
            }
        } else {
            const std::size_t end = c == '"' ? string_end(text, i) : std::max(bare_end(text, i), i + 1);
            std::size_t next = end;
            while (next < text.size() && is_space(text[next])) ++next;
            if (c == '"' && next < text.size() && text[next] == ':') {
                key = i;
            } else {
                out.push_back({key.value_or(i), i, end});
                key.reset();
            }
            i = end;
        }
    }
    return out;
}

bool is_member(std::string_view piece)
{
    return piece.starts_with('"') && piece.find("\":") != std::string_view::npos;
}

std::string_view piece(Random& random, bool member)
{
    for (;;) {
        const std::string_view one = kDictionary[below(random, std::size(kDictionary))];
        if (is_member(one) == member) return one;
    }
}

std::string number(Random& random)
{
    switch (below(random, 4)) {
        case 0:
            return std::to_string(below(random, 8));
        case 1:
            return std::to_string(std::uint64_t{1} << below(random, 64));
        case 2:
            return std::to_string(below(random, 300));
        default:
            return std::to_string((std::uint64_t{random()} << 32 | random()) >> below(random, 64));
    }
}

// The number that `text` is, moved a little; what is no whole number becomes one.
std::string nudged(Random& random, std::string_view text)
{
    std::int64_t value = 0;
    for (const char c : text.substr(0, 18))
        if (c >= '0' && c <= '9') value = value * 10 + (c - '0');
    constexpr std::array<std::int64_t, 8> kSteps = {1, -1, 2, -2, 4, -4, 12, -12};
    return std::to_string(value + kSteps[below(random, kSteps.size())]);
}

void edit_json(Random& random, std::string& text)
{
    const std::vector<Value> values = values_of(text);
    if (values.empty()) {
        text = R"({"asset":{"version":"2.0"}})";
        return;
    }
    const Value one = values[below(random, values.size())];
    const Value other = values[below(random, values.size())];
    const auto replace = [&](std::string_view with) { text.replace(one.begin, one.end - one.begin, with); };
    const std::string value = text.substr(one.begin, one.end - one.begin);
    const std::string entry = text.substr(one.entry, one.end - one.entry);
    switch (below(random, 12)) {
        case 0:
            return replace(number(random));
        case 1:
            return replace(nudged(random, value));
        case 2:
            return replace(std::string(text, other.begin, other.end - other.begin));
        case 3:
        case 4:
            return replace(piece(random, false));
        case 5: {  // without this entry, and without one comma beside it
            std::size_t begin = one.entry;
            std::size_t end = one.end;
            if (end < text.size() && text[end] == ',')
                ++end;
            else if (begin > 0 && text[begin - 1] == ',')
                --begin;
            text.erase(begin, end - begin);
            return;
        }
        case 6: {  // once more, or many times
            const std::size_t times = below(random, 4) == 0 ? 1 + below(random, 40) : 1;
            std::string more;
            for (std::size_t i = 0; i < times; ++i) more += "," + entry;
            text.insert(one.end, more);
            return;
        }
        case 7:
        case 8: {  // one more member, or a member in the place of this one
            const std::string member(piece(random, true));
            if (value.starts_with('{'))
                text.insert(one.begin + 1, value == "{}" ? member : member + ",");
            else if (one.entry != one.begin)
                text.replace(one.entry, one.end - one.entry, member);
            else
                text.insert(one.end, "," + std::string(piece(random, false)));
            return;
        }
        case 9: {
            const std::size_t depth = below(random, 8) == 0 ? below(random, 300) : 1;
            return replace(std::string(depth, '[') + value + std::string(depth, ']'));
        }
        case 10: {  // this entry under another name
            const std::string_view member = piece(random, true);
            if (one.entry == one.begin) return replace(nudged(random, value));
            text.replace(one.entry, one.begin - one.entry, member.substr(0, member.find("\":") + 2));
            return;
        }
        default: {
            std::string moved = text.substr(other.begin, other.end - other.begin);
            text.insert(one.end, (one.entry == one.begin ? "," : R"(,"extras":)") + moved);
            return;
        }
    }
}

struct Glb {
    std::string json;
    std::optional<std::string> binary;
};

std::uint32_t word(std::string_view bytes, std::size_t at)
{
    std::uint32_t out = 0;
    if (at + 4 <= bytes.size()) std::memcpy(&out, bytes.data() + at, 4);
    return out;
}

std::optional<Glb> split(std::string_view bytes)
{
    if (!bytes.starts_with("glTF") || bytes.size() < 20) return std::nullopt;
    Glb out;
    const std::size_t size = std::min<std::size_t>(word(bytes, 12), bytes.size() - 20);
    out.json = bytes.substr(20, size);
    const std::size_t second = 20 + size;
    if (second + 8 <= bytes.size()) out.binary = bytes.substr(second + 8);
    return out;
}

std::string joined(const Glb& parts)
{
    std::string out = "glTF";
    const auto append = [&](std::size_t value) {
        const auto bits = static_cast<std::uint32_t>(value);
        out.append(reinterpret_cast<const char*>(&bits), 4);
    };
    const std::string padding((4 - parts.json.size() % 4) % 4, ' ');
    const std::size_t json = parts.json.size() + padding.size();
    append(2);
    append(20 + json + (parts.binary ? 8 + parts.binary->size() : 0));
    append(json);
    out += "JSON" + parts.json + padding;
    if (parts.binary) {
        append(parts.binary->size());
        out += std::string_view("BIN\0", 4);
        out += *parts.binary;
    }
    return out;
}

void raw_mutate(std::string& bytes, std::size_t room)
{
    const std::size_t size = bytes.size();
    bytes.resize(size + std::min<std::size_t>(room, 64));
    bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size, bytes.size()));
}

// One word of the header or of a chunk's head, wrong.
void damage_head(Random& random, std::string& bytes)
{
    const std::size_t json = word(bytes, 12);
    const std::array<std::size_t, 6> places = {4, 8, 12, 16, 20 + json, 24 + json};
    const std::size_t at = places[below(random, places.size())];
    if (at + 4 > bytes.size()) return;
    const std::uint32_t old = word(bytes, at);
    const std::array<std::uint32_t, 6> choices = {0,           old + 1,     old - 1,
                                                  0x7fffffffu, 0xffffffffu, static_cast<std::uint32_t>(random())};
    std::memcpy(&bytes[at], &choices[below(random, choices.size())], 4);
}

std::string mutated(Random& random, std::string_view input, std::size_t max_size)
{
    const std::size_t room = max_size - std::min(max_size, input.size());
    if (below(random, kRawShare) == 0) {
        std::string out(input);
        raw_mutate(out, room);
        return out;
    }
    std::optional<Glb> glb = split(input);
    if (!glb) {
        std::string out(input);
        if (below(random, 64) == 0) return joined({.json = out, .binary = std::nullopt});
        const std::size_t edits = 1 + below(random, 3);
        for (std::size_t i = 0; i < edits; ++i) edit_json(random, out);
        return out;
    }
    switch (below(random, 8)) {
        case 0:
        case 1:
            if (!glb->binary) glb->binary = "";
            raw_mutate(*glb->binary, room);
            break;
        case 2: {
            std::string out = joined(*glb);
            damage_head(random, out);
            return out;
        }
        default:
            edit_json(random, glb->json);
    }
    return joined(*glb);
}

std::size_t give_back(const std::string& made, std::uint8_t* out, std::size_t max_size)
{
    const std::size_t size = std::min(made.size(), max_size);
    std::memcpy(out, made.data(), size);
    return size;
}

std::string_view view(const std::uint8_t* data, std::size_t size)
{
    return {reinterpret_cast<const char*>(data), size};
}

}  // namespace

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned int seed)
{
    Random random(seed);
    const std::string before(view(data, size));
    for (int tries = 0; tries < 4; ++tries) {  // a cut document is seldom worth running
        const std::string made = mutated(random, before, max_size);
        if (made.size() <= max_size) return give_back(made, data, max_size);
    }
    return LLVMFuzzerMutate(data, size, max_size);
}

// A value of the second document in the place of one of the first.
std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* data1, std::size_t size1, const std::uint8_t* data2,
                                      std::size_t size2, std::uint8_t* out, std::size_t max_out_size, unsigned int seed)
{
    Random random(seed);
    const std::string_view first = view(data1, size1);
    const std::string_view second = view(data2, size2);
    std::optional<Glb> into = split(first);
    const std::optional<Glb> from = split(second);
    std::string text = into ? into->json : std::string(first);
    const std::string other = from ? from->json : std::string(second);
    const std::vector<Value> here = values_of(text);
    const std::vector<Value> there = values_of(other);
    if (here.empty() || there.empty()) return 0;
    const Value place = here[below(random, here.size())];
    const Value taken = there[below(random, there.size())];
    text.replace(place.begin, place.end - place.begin, other, taken.begin, taken.end - taken.begin);
    if (into) {
        into->json = text;
        if (from && from->binary && below(random, 2) == 0) into->binary = from->binary;
        text = joined(*into);
    }
    return text.size() > max_out_size ? 0 : give_back(text, out, max_out_size);
}
