#pragma once
#include <utility>

namespace etalon::gpu {

struct DeviceState;

/// A Vulkan handle that is destroyed with its owner: `Destroy(state, handle)`. 16 bytes, movable, not copyable.
/// The Device it came from must outlive it, and the device must have finished with it (Device::wait).
template <class Handle, void (*Destroy)(const DeviceState&, Handle)>
class Owned {
 public:
    Owned() = default;
    Owned(const DeviceState& state, Handle handle) : handle_(handle), state_(&state) {}
    /// A handle that someone else destroys.
    static Owned borrow(Handle handle)
    {
        Owned borrowed;
        borrowed.handle_ = handle;
        return borrowed;
    }
    Owned(Owned&& other) noexcept
        : handle_(std::exchange(other.handle_, Handle{})), state_(std::exchange(other.state_, nullptr))
    {}
    Owned& operator=(Owned&& other) noexcept
    {
        std::swap(handle_, other.handle_);
        std::swap(state_, other.state_);
        return *this;
    }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;
    ~Owned()
    {
        if (handle_ != Handle{} && state_ != nullptr) Destroy(*state_, handle_);
    }

    Handle get() const { return handle_; }
    explicit operator bool() const { return handle_ != Handle{}; }

 private:
    Handle handle_{};
    const DeviceState* state_ = nullptr;
};

}  // namespace etalon::gpu
