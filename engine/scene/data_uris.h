#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace etalon {

/// JSON text whose long data: URIs have been taken out, so that no parser makes copies of megabytes. What stands in
/// their place, "data:@N", is no valid data URI, so that it cannot be mistaken.
class LiftedText {
 public:
    /// `text` must outlive this. It need not be JSON; what is no string of its own is left alone, and so are strings
    /// with escapes.
    explicit LiftedText(std::string_view text);

    std::string_view text() const { return uris_.empty() ? whole_ : std::string_view(short_); }
    /// The URI that `value` stands for, as a view of the whole text; `value` itself when it stands for none.
    std::string_view uri(std::string_view value) const;

 private:
    std::string_view whole_;
    std::string short_;
    std::vector<std::string_view> uris_;
};

}  // namespace etalon
