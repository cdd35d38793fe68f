#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/gltf_import.h"

namespace etalon::gltf {

/// Elements of an accessor: `components` numbers each, normalized integers mapped to [0, 1] or [-1, 1] by glTF's
/// equations, sparse elements in place. All finite: Error(input) otherwise.
template <typename T>
struct Numbers {
    std::size_t count = 0;
    std::size_t components = 0;
    std::vector<T> values;

    T at(std::size_t element, std::size_t component) const { return values[element * components + component]; }
};
using Floats = Numbers<float>;
using Doubles = Numbers<double>;

/// Which elements to read: all, or these, increasing.
using Subset = std::optional<std::vector<std::uint32_t>>;

/// Reads accessors that preflight has checked.
class AccessorReader {
 public:
    explicit AccessorReader(const Source& source) : source_(source) {}

    /// `pointer`: where the accessor is used, for messages. `components` lists how many each element may have.
    Floats floats(int accessor, std::initializer_list<std::size_t> components, const std::string& pointer,
                  const Subset& subset = {}) const;
    /// The same without rounding: for time, transforms and whatever else stays double in a Scene (matrices, 16
    /// components, by columns).
    Doubles doubles(int accessor, std::initializer_list<std::size_t> components, const std::string& pointer) const;
    /// Unsigned integers as they are: the joints of a skin, four a vertex.
    std::vector<std::uint32_t> joints(int accessor, const std::string& pointer, const Subset& subset) const;
    /// Unsigned scalars. The largest value of the type is refused: it would restart a primitive.
    std::vector<std::uint32_t> indices(int accessor, const std::string& pointer) const;
    std::size_t count(int accessor) const;

 private:
    template <typename T>
    Numbers<T> read(int accessor, std::initializer_list<std::size_t> components, const std::string& pointer,
                    const Subset& subset) const;

    const Source& source_;
};

}  // namespace etalon::gltf
