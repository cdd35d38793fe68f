#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <set>

#include "engine/scene/validate.h"

namespace etalon::document {

namespace {

constexpr Unsigned kFloat = 5126;
constexpr std::size_t kReadings = 4;  // of each byte of a buffer

/// One accessor's elements where they lie. Nothing of those that a compression extension gives.
class Elements {
 public:
    Elements(const json& accessor, std::span<const View> views, std::span<const GltfBuffer> buffers)
        : accessor_(accessor), views_(views), buffers_(buffers)
    {
        type_ = index_at(accessor, "componentType").value_or(0);
        count_ = index_at(accessor, "count").value_or(0);
        layout(text_at(accessor, "type"));
        if (const auto view = index_at(accessor, "bufferView")) {
            base_ = bytes_of(views[*view], buffers);
            is_known_ = !base_.empty() && !views[*view].is_decoded;
            if (is_known_) base_ = base_.subspan(index_at(accessor, "byteOffset").value_or(0));
            stride_ = views[*view].stride;
        } else {
            is_known_ = member(accessor, "sparse") != nullptr;  // zeros below it
        }
        is_known_ = is_known_ && components_ > 0 && (type_ <= kFloat);
        if (stride_ == 0) stride_ = size_;
        if (is_known_) read_sparse();
    }

    std::size_t components() const { return components_; }
    std::size_t values() const { return is_known_ ? count_ * components_ : 0; }
    bool is_float() const { return type_ == kFloat; }

    /// Calls `with(i, values)` for every element in order.
    template <typename With>
    void each(const With& with) const
    {
        if (!is_known_) return;
        switch (type_) {
            case 5120:
                return each_of<std::int8_t>(with);
            case 5121:
                return each_of<std::uint8_t>(with);
            case 5122:
                return each_of<std::int16_t>(with);
            case 5123:
                return each_of<std::uint16_t>(with);
            case 5125:
                return each_of<std::uint32_t>(with);
            default:
                return each_of<float>(with);
        }
    }

 private:
    /// Columns of small matrices begin at multiples of four bytes.
    void layout(std::string_view type)
    {
        struct Type {
            std::string_view name;
            std::size_t columns, rows;
        };
        constexpr std::array kTypes{Type{"SCALAR", 1, 1}, Type{"VEC2", 1, 2}, Type{"VEC3", 1, 3}, Type{"VEC4", 1, 4},
                                    Type{"MAT2", 2, 2},   Type{"MAT3", 3, 3}, Type{"MAT4", 4, 4}};
        const auto row = std::ranges::find(kTypes, type, &Type::name);
        if (row == kTypes.end()) return;
        const std::size_t bytes = type_ <= 5121 ? 1 : type_ <= 5123 ? 2 : 4;
        const std::size_t column = row->columns > 1 ? (row->rows * bytes + 3) / 4 * 4 : row->rows * bytes;
        for (std::size_t c = 0; c < row->columns; ++c)
            for (std::size_t r = 0; r < row->rows; ++r) places_[components_++] = c * column + r * bytes;
        size_ = (row->columns - 1) * column + row->rows * bytes;
    }

    void read_sparse()
    {
        const json* sparse = member(accessor_, "sparse");
        if (sparse == nullptr) return;
        const auto bytes = [&](const json& part) {
            const View& view = views_[part["bufferView"].get<std::size_t>()];
            const auto all = view.is_decoded ? std::span<const std::byte>{} : bytes_of(view, buffers_);
            return all.empty() ? all : all.subspan(index_at(part, "byteOffset").value_or(0));
        };
        const json& indices = (*sparse)["indices"];
        const std::span<const std::byte> places = bytes(indices);
        sparse_ = bytes((*sparse)["values"]);
        is_known_ = !places.empty() && !sparse_.empty();
        if (!is_known_) return;
        const std::size_t type = index_at(indices, "componentType").value_or(0);
        const std::size_t size = type == 5121 ? 1 : type == 5123 ? 2 : 4;
        const std::size_t count = index_at(*sparse, "count").value_or(0);
        for (std::size_t i = 0; i < count; ++i) {
            std::uint32_t at = 0;
            std::memcpy(&at, &places[i * size], size);  // little-endian, as the file
            sparse_places_.push_back(at);
        }
        is_known_ = std::ranges::is_sorted(sparse_places_);  // the reader refuses others
    }

    template <typename T, typename With>
    void each_of(const With& with) const
    {
        std::array<double, 16> values{};
        std::size_t next = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const std::byte* from = base_.empty() ? nullptr : &base_[i * stride_];
            if (next < sparse_places_.size() && sparse_places_[next] == i) from = &sparse_[size_ * next++];
            for (std::size_t c = 0; c < components_; ++c) {
                T value{};
                if (from != nullptr) std::memcpy(&value, from + places_[c], sizeof value);
                values[c] = static_cast<double>(value);
            }
            with(i, std::span<const double>(values).first(components_));
        }
    }

    const json& accessor_;
    std::span<const View> views_;
    std::span<const GltfBuffer> buffers_;
    Unsigned type_ = 0;
    std::size_t count_ = 0;
    std::size_t components_ = 0;
    std::size_t size_ = 0;
    std::size_t stride_ = 0;
    std::array<std::size_t, 16> places_{};  ///< of the components in an element
    std::span<const std::byte> base_, sparse_;
    std::vector<std::size_t> sparse_places_;
    bool is_known_ = false;
};

class Values {
 public:
    Values(const json& document, std::span<const View> views, std::span<const GltfBuffer> buffers, Findings& findings)
        : document_(document), views_(views), buffers_(buffers), findings_(findings)
    {
        for (const GltfBuffer& buffer : buffers) budget_ += kReadings * buffer.bytes.size();
    }

    void check_all()
    {
        std::size_t i = 0;
        for (const json& accessor : collection(document_, "/accessors"))
            bounds(accessor, fmt::format("/accessors/{}", i++));
        visit(document_, "/meshes/*/primitives/*/attributes/*",
              [&](const json& accessor, const Place& at) { attribute(accessor, at); });
        visit(document_, "/animations/*/samplers/*/input",
              [&](const json& accessor, const Place& at) { times(accessor, at.pointer()); });
        visit(document_, "/animations/*",
              [&](const json& animation, const Place& place) { rotations(animation, place); });
        visit(document_, "/skins/*/inverseBindMatrices",
              [&](const json& accessor, const Place& at) { bind_matrices(accessor, at.pointer()); });
    }

 private:
    Elements elements(std::size_t accessor) const
    {
        return Elements(collection(document_, "/accessors")[accessor], views_, buffers_);
    }

    /// Whether values may still be looked at. Many accessors may show the same bytes, so that a small file could ask
    /// for any amount of work; no honest one asks for its bytes so often.
    bool afford(const Elements& elements)
    {
        if (elements.values() > budget_) return false;
        budget_ -= elements.values();
        return true;
    }

    /// Whether `accessor` has not been looked at for `reason` before: primitives and channels share them.
    bool is_first(std::size_t accessor, std::string_view reason) { return seen_.emplace(accessor, reason).second; }

    void bounds(const json& accessor, const std::string& pointer)
    {
        const Elements elements(accessor, views_, buffers_);
        const json* declared[] = {member(accessor, "min"), member(accessor, "max")};
        // Integers without declared bounds have nothing to be checked against.
        if (declared[0] == nullptr && declared[1] == nullptr && !elements.is_float()) return;
        if (!afford(elements)) return;
        std::array<double, 16> low, high;
        low.fill(HUGE_VAL);
        high.fill(-HUGE_VAL);
        bool is_finite = true, is_empty = true;
        elements.each([&](std::size_t, std::span<const double> values) {
            is_empty = false;
            for (std::size_t c = 0; c < values.size(); ++c) {
                is_finite = is_finite && std::isfinite(values[c]);
                low[c] = std::min(low[c], values[c]);
                high[c] = std::max(high[c], values[c]);
            }
        });
        if (is_empty) return;
        if (!is_finite) return findings_.add(pointer, "a value is not finite", "ACCESSOR_INVALID_FLOAT");
        const auto compare = [&](const json* values, const char* key, const std::array<double, 16>& found,
                                 std::string_view code) {
            if (values == nullptr || !values->is_array() || values->size() != elements.components()) return;
            for (std::size_t c = 0; c < values->size(); ++c) {
                if (!(*values)[c].is_number()) continue;
                const auto said = (*values)[c].get<double>();
                if ((elements.is_float() ? double(float(said)) : said) != found[c])
                    findings_.add(fmt::format("{}/{}/{}", pointer, key, c),
                                  fmt::format("says {}, but it is {}", said, found[c]), code);
            }
        };
        compare(declared[0], "min", low, "ACCESSOR_MIN_MISMATCH");
        compare(declared[1], "max", high, "ACCESSOR_MAX_MISMATCH");
    }

    void attribute(const json& accessor, const Place& at)
    {
        const bool is_tangent = at.key == "TANGENT";
        const bool is_color = at.key.starts_with("COLOR_");
        if (!is_tangent && !is_color && at.key != "NORMAL") return;
        if (!is_first(accessor.get<std::size_t>(), at.key)) return;
        const Elements found = elements(accessor.get<std::size_t>());
        if (!found.is_float() || !afford(found)) return;
        std::size_t not_unit = 0, no_sign = 0, not_clamped = 0;
        found.each([&](std::size_t, std::span<const double> v) {
            if (is_color) {
                not_clamped += std::ranges::any_of(v, [](double c) { return c < 0 || c > 1; }) ? 1u : 0u;
            } else if (v.size() >= 3) {
                const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
                not_unit += std::fabs(length - 1) > kUnitVector ? 1u : 0u;
                no_sign += is_tangent && v.size() == 4 && std::fabs(v[3]) != 1 ? 1u : 0u;
            }
        });
        const auto report = [&](std::size_t count, std::string_view what, std::string_view code) {
            if (count > 0) findings_.add(at.pointer(), fmt::format("{} {}", count, what), code);
        };
        report(not_unit, "vectors are not of unit length", "ACCESSOR_VECTOR3_NON_UNIT");
        report(no_sign, "tangents have a sign that is neither 1 nor -1", "ACCESSOR_INVALID_SIGN");
        report(not_clamped, "colours are not between 0 and 1", "ACCESSOR_NON_CLAMPED");
    }

    void times(const json& accessor, const std::string& pointer)
    {
        const Elements found = elements(accessor.get<std::size_t>());
        if (!is_first(accessor.get<std::size_t>(), "times") || !afford(found)) return;
        double before = -HUGE_VAL;
        bool is_negative = false, is_rising = true;
        found.each([&](std::size_t, std::span<const double> v) {
            is_negative = is_negative || v[0] < 0;
            is_rising = is_rising && v[0] > before;
            before = v[0];
        });
        if (is_negative) findings_.add(pointer, "a time is negative", "ACCESSOR_ANIMATION_INPUT_NEGATIVE");
        if (!is_rising) findings_.add(pointer, "times do not rise", "ACCESSOR_ANIMATION_INPUT_NON_INCREASING");
    }

    void rotations(const json& animation, const Place& place)
    {
        const json& samplers = collection(animation, "/samplers");
        visit(
            animation, "/channels/*",
            [&](const json& channel, const Place& at) {
                const json* target = member(channel, "target");
                const auto number = index_at(channel, "sampler");
                if (target == nullptr || text_at(*target, "path") != "rotation" || !number ||
                    *number >= samplers.size())
                    return;
                const json& sampler = samplers[*number];
                const auto output = index_at(sampler, "output");
                if (!output || !is_first(*output, "rotation")) return;
                const Elements found = elements(*output);
                if (!found.is_float() || found.components() != 4 || !afford(found)) return;
                // Of a spline's three quaternions at a key the outer ones are tangents.
                const bool is_spline = text_at(sampler, "interpolation") == "CUBICSPLINE";
                std::size_t not_unit = 0;
                found.each([&](std::size_t i, std::span<const double> q) {
                    if (is_spline && i % 3 != 1) return;
                    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
                    not_unit += std::fabs(length - 1) > kUnitQuaternion ? 1u : 0u;
                });
                if (not_unit > 0)
                    findings_.add(at.pointer() + "/sampler",
                                  fmt::format("{} rotations are not of unit length", not_unit),
                                  "ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION");
            },
            place);
    }

    void bind_matrices(const json& accessor, const std::string& pointer)
    {
        const Elements found = elements(accessor.get<std::size_t>());
        if (!is_first(accessor.get<std::size_t>(), "matrices") || !afford(found)) return;
        bool is_affine = true;
        found.each([&](std::size_t, std::span<const double> m) {
            if (m.size() == 16) is_affine = is_affine && m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1;
        });
        if (!is_affine) findings_.add(pointer, "the last row of a matrix is not 0 0 0 1", "ACCESSOR_INVALID_IBM");
    }

    const json& document_;
    std::span<const View> views_;
    std::span<const GltfBuffer> buffers_;
    Findings& findings_;
    std::set<std::pair<std::size_t, std::string_view>> seen_;
    std::size_t budget_ = std::size_t{1} << 24;  ///< values; those of sparse accessors need no bytes
};

}  // namespace

void validate_values(const json& document, std::span<const View> views, std::span<const GltfBuffer> buffers,
                     Findings& findings)
{
    Values(document, views, buffers, findings).check_all();
}

}  // namespace etalon::document
