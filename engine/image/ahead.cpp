#include "engine/image/ahead.h"

#include <exception>
#include <system_error>

#include "engine/image/picture_library.h"

namespace etalon {

std::jthread load_pictures_ahead()
{
    const auto load = [] {
        try {
            codec::picture_library();
        } catch (const std::exception&) {
            // Tried again, and said, where it is needed.
        }
    };
    try {
        return std::jthread(load);
    } catch (const std::system_error&) {
        return {};  // no thread to be had
    }
}

}  // namespace etalon
