#include "engine/scene/resources.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/base/error.h"

namespace etalon {

namespace {

constexpr std::size_t kShownUri = 80;  // enough of a long URI to know which it is

std::string shown(std::string_view uri)
{
    return uri.size() <= kShownUri ? std::string(uri)
                                   : fmt::format("{}… ({} bytes)", uri.substr(0, kShownUri), uri.size());
}

class Descriptor {
 public:
    explicit Descriptor(int value) : value_(value) {}
    Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
    Descriptor& operator=(Descriptor&&) = delete;
    ~Descriptor()
    {
        if (value_ >= 0) ::close(value_);
    }
    int get() const { return value_; }
    bool is_open() const { return value_ >= 0; }

 private:
    int value_;
};

Error refused(std::string_view uri, std::string_view why)
{
    return Error(Blame::input, fmt::format("\"{}\" {}", shown(uri), why),
                 "keep buffers and images in the folder of the glTF file or below it, under relative names");
}

// Kernels before 5.6 and some sandboxes have no openat2: then the resolved path itself must lie below the folder.
Descriptor open_by_real_path(const std::filesystem::path& folder, const std::string& relative, std::string_view uri)
{
    std::error_code error;
    const std::filesystem::path root = std::filesystem::canonical(folder, error);
    const std::filesystem::path full = std::filesystem::canonical(folder / relative, error);
    if (error) {
        errno = error.value();
        return Descriptor(-1);
    }
    const std::filesystem::path inside = full.lexically_relative(root);
    if (inside.empty() || *inside.begin() == "..") throw refused(uri, "leads out of the scene's folder");
    return Descriptor(::open(full.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW));
}

Descriptor open_beneath(const std::filesystem::path& folder, const std::string& relative, std::string_view uri)
{
    const Descriptor root(::open(folder.empty() ? "." : folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (!root.is_open())
        throw refused(uri, fmt::format("cannot be sought: folder {}: {}", folder.string(), std::strerror(errno)));
    open_how how{};
    how.flags = O_RDONLY | O_NONBLOCK | O_CLOEXEC;  // nonblocking: a pipe must not hold us
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
    Descriptor file(static_cast<int>(::syscall(SYS_openat2, root.get(), relative.c_str(), &how, sizeof how)));
    if (file.is_open()) return file;
    if (errno == EXDEV || errno == ELOOP) throw refused(uri, "leads out of the scene's folder");
    if (errno == ENOSYS || errno == EPERM) return open_by_real_path(folder.empty() ? "." : folder, relative, uri);
    return file;
}

// RFC 3986: a scheme is a letter, then letters, digits, + - . up to a colon.
std::string_view scheme_of(std::string_view uri)
{
    const std::size_t colon = uri.find(':');
    if (colon == std::string_view::npos || colon == 0) return {};
    for (std::size_t i = 0; i < colon; ++i) {
        const char c = uri[i];
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (!letter && (i == 0 || !((c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.'))) return {};
    }
    return uri.substr(0, colon);
}

// The decoded relative path of a file URI; refuses other schemes and absolute paths.
std::string relative_path(std::string_view uri)
{
    const std::string_view scheme = scheme_of(uri);
    if (!scheme.empty())
        throw refused(uri, fmt::format("is not read: only files and data URIs are, no \"{}:\"", scheme));
    std::string relative = percent_decoded(uri);
    if (relative.empty()) throw refused(uri, "names no file");
    if (relative.front() == '/') throw refused(uri, "is an absolute path");
    return relative;
}

struct OpenFile {
    Descriptor descriptor;
    std::size_t size;
};

OpenFile open_regular(const std::filesystem::path& folder, const std::string& relative, std::string_view uri)
{
    Descriptor file = open_beneath(folder, relative, uri);
    if (!file.is_open())
        throw Error(Blame::input, fmt::format("cannot read \"{}\": {}", shown(uri), std::strerror(errno)),
                    "put the file beside the glTF file, or export again");
    struct stat status {};
    if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) throw refused(uri, "is not a regular file");
    return {std::move(file), static_cast<std::size_t>(status.st_size)};
}

std::vector<std::byte> read_beneath(const std::filesystem::path& folder, std::string_view uri, std::size_t max_bytes,
                                    std::size_t wanted)
{
    const OpenFile file = open_regular(folder, relative_path(uri), uri);
    const std::size_t size = std::min(file.size, wanted);
    if (size > max_bytes) throw refused(uri, fmt::format("has {} bytes; the limit is {}", size, max_bytes));
    std::vector<std::byte> out(size);
    std::size_t done = 0;
    while (done < out.size()) {
        const ssize_t got = ::read(file.descriptor.get(), out.data() + done, out.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw refused(uri, std::strerror(errno));
        if (got == 0) break;  // it shrank meanwhile
        done += static_cast<std::size_t>(got);
    }
    out.resize(done);
    return out;
}

std::vector<std::byte> decode_data_uri(std::string_view uri, std::size_t max_bytes)
{
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos) throw refused(uri, "is a data URI without a comma");
    const std::string_view head = uri.substr(0, comma);
    const std::string_view body = uri.substr(comma + 1);
    if (body.size() / 4 * 3 > max_bytes) throw refused(uri, fmt::format("is over the limit of {} bytes", max_bytes));
    try {
        if (head.ends_with(";base64")) return base64_decoded(body);
        const std::string text = percent_decoded(body);
        const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
        return {bytes, bytes + text.size()};
    } catch (Error& error) {
        throw error.at(shown(uri));
    }
}

int hex_digit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

constexpr std::array<std::int8_t, 256> kBase64 = [] {
    std::array<std::int8_t, 256> table{};
    table.fill(-1);
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < alphabet.size(); ++i)
        table[static_cast<unsigned char>(alphabet[i])] = static_cast<std::int8_t>(i);
    return table;
}();

}  // namespace

std::string percent_decoded(std::string_view text)
{
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned char c = static_cast<unsigned char>(text[i]);
        if (c == '%') {
            const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
            const int low = high >= 0 ? hex_digit(text[i + 2]) : -1;
            if (low < 0) throw refused(text, "has a bad % escape");
            c = static_cast<unsigned char>(high * 16 + low);
            i += 2;
        }
        if (c < 0x20 || c == 0x7f) throw refused(text, "holds a control character");
        out.push_back(static_cast<char>(c));
    }
    return out;
}

std::vector<std::byte> base64_decoded(std::string_view text)
{
    while (text.ends_with('=')) text.remove_suffix(1);
    std::vector<std::byte> out;
    out.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int held = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const int value = kBase64[static_cast<unsigned char>(text[i])];
        if (value < 0)
            throw Error(
                Blame::input,
                fmt::format("base64: byte {} (0x{:02x}) does not belong", i, static_cast<unsigned char>(text[i])),
                "encode the data again");
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        held += 6;
        if (held >= 8) {
            held -= 8;
            out.push_back(static_cast<std::byte>(bits >> held & 0xffu));
        }
    }
    return out;
}

std::vector<std::byte> read_uri(std::string_view uri, const std::filesystem::path& folder, std::size_t max_bytes,
                                std::size_t wanted)
{
    if (scheme_of(uri) == "data") return decode_data_uri(uri, max_bytes);
    return read_beneath(folder, uri, max_bytes, wanted);
}

std::filesystem::path confined_path(std::string_view uri, const std::filesystem::path& folder)
{
    const std::string relative = relative_path(uri);
    open_regular(folder, relative, uri);
    return folder / relative;
}

}  // namespace etalon
