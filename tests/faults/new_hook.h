#pragma once
#include <cstddef>

namespace etalon::test {

/// This program's `operator new`, which can be told to fail. It counts allocations made by our own code, directly or
/// through the standard library and the libraries that we call and that promise exceptions (fmt, SPIRV-Cross); a Vulkan
/// driver, its compiler, SPIRV-Tools and the layers are left alone, for they end the program where memory does.
class FailingNew {
 public:
    /// From now on the allocation `nth`, counted from 0, throws std::bad_alloc, and `times` - 1 after it.
    FailingNew(std::size_t nth, std::size_t times);
    ~FailingNew();
    FailingNew(const FailingNew&) = delete;
    FailingNew& operator=(const FailingNew&) = delete;

    std::size_t counted() const;
    bool failed() const { return counted() > nth_; }

 private:
    std::size_t nth_;
};

}  // namespace etalon::test
