#include "tests/faults/new_hook.h"

#include <execinfo.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

#include "engine/gpu/shader.h"

namespace etalon::test {
namespace {

struct Range {
    std::uintptr_t begin = 0;
    std::uintptr_t end = 0;
    bool holds(const void* address) const
    {
        const auto at = reinterpret_cast<std::uintptr_t>(address);
        return at >= begin && at < end;
    }
};

/// Where code is: ours, and that of the libraries which throw to us or are below all. Looked up once.
struct Modules {
    std::array<Range, 8> ours;
    std::size_t count = 0;

    static int add(dl_phdr_info* info, std::size_t, void* data)
    {
        auto& modules = *static_cast<Modules*>(data);
        Range range{~std::uintptr_t{0}, 0};
        for (int i = 0; i < info->dlpi_phnum; ++i) {
            const auto& segment = info->dlpi_phdr[i];
            if (segment.p_type != PT_LOAD) continue;
            range.begin = std::min<std::uintptr_t>(range.begin, info->dlpi_addr + segment.p_vaddr);
            range.end = std::max<std::uintptr_t>(range.end, info->dlpi_addr + segment.p_vaddr + segment.p_memsz);
        }
        constexpr const char* kThrowing[] = {"libstdc++", "libfmt", "libspirv-cross", "/libc.", "libasan"};
        const bool program = info->dlpi_name[0] == '\0' && modules.count == 0;
        const bool throwing = std::any_of(std::begin(kThrowing), std::end(kThrowing), [&](const char* name) {
            return std::strstr(info->dlpi_name, name) != nullptr;
        });
        if ((program || throwing) && modules.count < modules.ours.size()) modules.ours[modules.count++] = range;
        return 0;
    }
};

const Modules modules = [] {
    Modules found;
    dl_iterate_phdr(Modules::add, &found);
    return found;
}();

std::atomic<bool> armed{false};
std::atomic<std::size_t> count{0};
std::atomic<std::size_t> first{0};
std::atomic<std::size_t> last{0};
thread_local bool looking = false;

/// Whether our code asked for it: nothing between it and operator new is of a library that does not throw. All of the
/// stack counts, for templates of the standard library that are in the program serve every library.
bool is_ours(const void* caller)
{
    const auto throwing = [](const void* frame) {
        return std::any_of(modules.ours.begin(), modules.ours.begin() + modules.count,
                           [&](const Range& range) { return range.holds(frame); });
    };
    if (!throwing(caller)) return false;  // the most are a compiler's, and unwinding is slow
    std::array<void*, 64> stack;
    const int depth = backtrace(stack.data(), static_cast<int>(stack.size()));
    return std::all_of(stack.data(), stack.data() + depth, throwing);
}

bool must_fail(const void* caller)
{
    if (!armed.load(std::memory_order_relaxed) || looking) return false;
    looking = true;
    const bool ours = is_ours(caller);
    looking = false;
    if (!ours) return false;
    const std::size_t index = count.fetch_add(1);
    return index >= first && index < last;
}

}  // namespace

FailingNew::FailingNew(std::size_t nth, std::size_t times) : nth_(nth)
{
    count = 0;
    first = nth;
    last = times > ~nth ? ~std::size_t{0} : nth + times;
    armed = true;
}

FailingNew::~FailingNew()
{
    armed = false;
}

std::size_t FailingNew::counted() const
{
    return count;
}

__attribute__((noinline)) static void* allocate(std::size_t size, std::size_t alignment, const void* caller)
{
    if (must_fail(caller)) throw std::bad_alloc();
    void* const memory = alignment <= alignof(std::max_align_t)
                             ? std::malloc(std::max<std::size_t>(size, 1))
                             : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

/// No allocation of this thread counts while it lives.
class Uncounted {
 public:
    Uncounted() : before_(looking) { looking = true; }
    ~Uncounted() { looking = before_; }
    Uncounted(const Uncounted&) = delete;
    Uncounted& operator=(const Uncounted&) = delete;

 private:
    bool before_;
};

}  // namespace etalon::test

// SPIRV-Tools stands in the program and does not throw; linked with --wrap (CMakeLists.txt), it is left alone too.
std::vector<std::uint32_t> specialize_really(const etalon::gpu::ShaderSpec& shader) asm(
    "__real__ZN6etalon3gpu10specializeERKNS0_10ShaderSpecE");
std::vector<std::uint32_t> specialize_uncounted(const etalon::gpu::ShaderSpec& shader) asm(
    "__wrap__ZN6etalon3gpu10specializeERKNS0_10ShaderSpecE");
std::vector<std::uint32_t> specialize_uncounted(const etalon::gpu::ShaderSpec& shader)
{
    const etalon::test::Uncounted uncounted;
    return specialize_really(shader);
}

void* operator new(std::size_t size)
{
    return etalon::test::allocate(size, 1, __builtin_return_address(0));
}
void* operator new[](std::size_t size)
{
    return etalon::test::allocate(size, 1, __builtin_return_address(0));
}
void* operator new(std::size_t size, std::align_val_t alignment)
{
    return etalon::test::allocate(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
void* operator new[](std::size_t size, std::align_val_t alignment)
{
    return etalon::test::allocate(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
// What asks for no exception is never failed, but must come from where `operator delete` below brings it back.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
    return std::malloc(std::max<std::size_t>(size, 1));
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept
{
    return std::malloc(std::max<std::size_t>(size, 1));
}
void operator delete(void* memory) noexcept
{
    std::free(memory);
}
void operator delete[](void* memory) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept
{
    std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept
{
    std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept
{
    std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept
{
    std::free(memory);
}
