#pragma once
#include <memory>
#include <string>

#include "engine/gpu/device.h"
#include "engine/math/types.h"

namespace etalon {

/// What the user did since it was last asked. Pointer moves are in fractions of the window's height.
struct WindowInput {
    dvec2 orbit{0};    ///< left button held
    dvec2 pan{0};      ///< right or middle button held
    double zoom = 0;   ///< wheel steps, up is positive
    std::string keys;  ///< characters of the keys pressed, in capitals; '?' for the help key
    bool close = false;
};

/// A window of the desktop, of which there may be one. Throws Error(machine) when there is no display.
class Window {
 public:
    Window(const std::string& title, ivec2 size);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Adds what a Device needs to present here. The window must outlive the device.
    void require(gpu::DeviceOptions& options) const;
    /// Waits at most `seconds` for something to happen.
    WindowInput poll(double seconds);
    /// Pixels; (0, 0) while minimised.
    ivec2 size() const;
    void set_title(const std::string& title);

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace etalon
