#include "samples/viewer/window.h"

#include <vulkan/vulkan_core.h>
// After Vulkan's types, so that it declares glfwCreateWindowSurface.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/error.h"

namespace etalon {
namespace {

/// GLFW as long as this lives.
struct Library {
    Library()
    {
        if (glfwInit() != GLFW_TRUE) throw_glfw("there is no display to open a window on");
    }
    ~Library() { glfwTerminate(); }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

    [[noreturn]] static void throw_glfw(const std::string& what)
    {
        const char* why = nullptr;
        glfwGetError(&why);
        throw Error(Blame::machine, why == nullptr ? what : fmt::format("{} ({})", what, why),
                    "run in a graphical session, or render to a file with `etalon render`");
    }
};

}  // namespace

struct Window::State {
    Library library;
    GLFWwindow* window = nullptr;
    WindowInput input;
    dvec2 pointer{0};

    ~State()
    {
        if (window != nullptr) glfwDestroyWindow(window);
    }

    static State& of(GLFWwindow* window) { return *static_cast<State*>(glfwGetWindowUserPointer(window)); }

    static void on_move(GLFWwindow* window, double x, double y)
    {
        State& state = of(window);
        int width = 0;
        int height = 0;
        glfwGetWindowSize(window, &width, &height);
        const dvec2 moved = (dvec2(x, y) - state.pointer) / static_cast<double>(std::max(height, 1));
        state.pointer = dvec2(x, y);
        const auto held = [&](int button) { return glfwGetMouseButton(window, button) == GLFW_PRESS; };
        if (held(GLFW_MOUSE_BUTTON_LEFT))
            state.input.orbit += moved;
        else if (held(GLFW_MOUSE_BUTTON_RIGHT) || held(GLFW_MOUSE_BUTTON_MIDDLE))
            state.input.pan += moved;
    }

    static void on_wheel(GLFWwindow* window, double, double y) { of(window).input.zoom += y; }

    static void on_key(GLFWwindow* window, int key, int, int action, int mods)
    {
        if (action != GLFW_PRESS) return;
        State& state = of(window);
        if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(window, GLFW_TRUE);
        if (key == GLFW_KEY_SLASH && (mods & GLFW_MOD_SHIFT) != 0) state.input.keys += '?';
        if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) state.input.keys += static_cast<char>('A' + (key - GLFW_KEY_A));
    }
};

Window::Window(const std::string& title, ivec2 size) : state_(std::make_unique<State>())
{
    if (glfwVulkanSupported() != GLFW_TRUE) Library::throw_glfw("this machine cannot show Vulkan pictures in a window");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    state_->window = glfwCreateWindow(size.x, size.y, title.c_str(), nullptr, nullptr);
    if (state_->window == nullptr) Library::throw_glfw("the window does not open");
    glfwSetWindowUserPointer(state_->window, state_.get());
    glfwGetCursorPos(state_->window, &state_->pointer.x, &state_->pointer.y);
    glfwSetCursorPosCallback(state_->window, State::on_move);
    glfwSetScrollCallback(state_->window, State::on_wheel);
    glfwSetKeyCallback(state_->window, State::on_key);
}

Window::~Window() = default;

void Window::require(gpu::DeviceOptions& options) const
{
    std::uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (names == nullptr) Library::throw_glfw("this machine cannot show Vulkan pictures in a window");
    options.instance_extensions.assign(names, names + count);
    options.make_surface = [window = state_->window](VkInstance instance) {
        VkSurfaceKHR surface = VK_NULL_HANDLE;
        if (glfwCreateWindowSurface(instance, window, nullptr, &surface) != VK_SUCCESS)
            Library::throw_glfw("Vulkan cannot draw on this window");
        return surface;
    };
}

WindowInput Window::poll(double seconds)
{
    if (seconds > 0)
        glfwWaitEventsTimeout(seconds);
    else
        glfwPollEvents();
    WindowInput input = std::exchange(state_->input, {});
    input.close = glfwWindowShouldClose(state_->window) == GLFW_TRUE;
    return input;
}

ivec2 Window::size() const
{
    if (glfwGetWindowAttrib(state_->window, GLFW_ICONIFIED) == GLFW_TRUE) return ivec2(0);
    ivec2 pixels(0);
    glfwGetFramebufferSize(state_->window, &pixels.x, &pixels.y);
    return pixels;
}

void Window::set_title(const std::string& title)
{
    glfwSetWindowTitle(state_->window, title.c_str());
}

}  // namespace etalon
