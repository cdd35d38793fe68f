#pragma once
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace etalon {

/// A fingerprint of values in the order in which they are added: changing any one of them changes it, and two of
/// different values are alike once in 2⁶⁴. It tells what was damaged or mistaken for another, not what was forged.
class Digest {
 public:
    void add(std::uint64_t word)
    {
        // One to one in `word` and in what came before; the shift brings the high bits down, which products never do.
        state_ = (state_ ^ word) * 0x9e3779b97f4a7c15u;
        state_ ^= state_ >> 32;
    }
    template <std::integral T>
    requires(sizeof(T) < 8 || std::signed_integral<T>) void add(T value) { add(static_cast<std::uint64_t>(value)); }
    /// By its bits: -0 is not 0.
    void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
    /// Bytes and their number.
    void add(std::span<const std::byte> bytes)
    {
        add(bytes.size());
        for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
            std::uint64_t word = 0;
            std::memcpy(&word, bytes.data(), 8);
            add(word);
        }
        std::uint64_t rest = 0;
        if (!bytes.empty()) std::memcpy(&rest, bytes.data(), bytes.size());
        add(rest);
    }
    void add(std::string_view text) { add(std::as_bytes(std::span(text))); }

    std::uint64_t value() const { return state_; }
    /// 16 hexadecimal digits.
    std::string text() const
    {
        std::string out(16, '0');
        for (std::size_t i = 0; i < 16; ++i) out[i] = "0123456789abcdef"[state_ >> (60 - 4 * i) & 15];
        return out;
    }

 private:
    std::uint64_t state_ = 0x243f6a8885a308d3u;  // digits of π: empty is not 0
};

}  // namespace etalon
