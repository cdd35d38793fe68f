#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "engine/base/error.h"
#include "engine/gpu/probe.h"
#include "etalon_version.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/json.h"
#include "tools/etalon/scene_info.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

/// What this machine can do, and the proof.
struct Machine {
    std::vector<std::string> versions;
    std::vector<gpu::DeviceReport> devices;
    gpu::ProbeResult vulkan;
    std::vector<gpu::DeviceReport> contexts;  ///< of OpenGL
    std::vector<gpu::ProbeResult> opengl;     ///< of each
    std::vector<std::string> validation;      ///< what the backends said during the probes, with --validate
    unsigned threads = 0;

    bool opengl_works() const
    {
        return std::any_of(opengl.begin(), opengl.end(), [](const gpu::ProbeResult& probe) { return probe.works; });
    }
    bool works() const { return (vulkan.works || opengl_works()) && validation.empty(); }
};

void examine_vulkan(const gpu::DeviceOptions& options, Machine& machine)
{
    // A back end that fails is what this command is asked to report, so the failure ends here and not in main.
    try {
        const std::vector<std::string> vulkan = gpu::vulkan_versions();
        machine.versions.insert(machine.versions.end(), vulkan.begin(), vulkan.end());
        machine.devices = gpu::list_devices(options);
        gpu::Device device(options);
        machine.vulkan = gpu::probe(device);
        machine.validation = device.validation_messages();
    } catch (const Error& error) {
        machine.vulkan.detail = error.message();
    }
}

void examine_opengl(const gpu::DeviceOptions& options, Machine& machine)
{
    machine.contexts = gpu::list_devices(options);
    for (const gpu::DeviceReport& context : machine.contexts) {
        gpu::ProbeResult& result = machine.opengl.emplace_back();
        try {
            gpu::DeviceOptions one = options;
            one.device = fmt::format("{}", context.index);
            gpu::Device device(one);
            result = gpu::probe(device);
            const std::vector<std::string> said = device.validation_messages();
            machine.validation.insert(machine.validation.end(), said.begin(), said.end());
        } catch (const Error& error) {
            result.detail = error.message();
        }
    }
}

Machine examine(const gpu::DeviceOptions& options)
{
    Machine machine;
    machine.versions = {fmt::format("etalon {}", kVersionFull), fmt::format("compiler {}", kCompiler)};
    machine.threads = std::thread::hardware_concurrency();
    gpu::DeviceOptions opengl = options;
    opengl.backend = gpu::Backend::opengl;
    gpu::DeviceOptions vulkan = options;
    vulkan.backend = gpu::Backend::vulkan;
    examine_vulkan(vulkan, machine);
    examine_opengl(opengl, machine);
    return machine;
}

std::string gibibytes(std::uint64_t bytes)
{
    return fmt::format("{:.1f} GiB", static_cast<double>(bytes) / (1ull << 30));
}

std::string as_text(const Machine& machine)
{
    std::string text;
    for (const std::string& line : machine.versions) text += line + '\n';
    text += fmt::format("\ndevices: {}\n", machine.devices.size());
    for (const gpu::DeviceReport& device : machine.devices) {
        text +=
            fmt::format("{} {} {} ({}, {}), {}, Vulkan {}, {}\n", device.chosen ? '*' : ' ', device.index, device.name,
                        name(device.kind), device.type, device.driver, device.api_version, gibibytes(device.memory));
        for (const std::string& reason : device.reasons) text += fmt::format("      not chosen: {}\n", reason);
    }
    text += fmt::format("\nOpenGL contexts: {}\n", machine.contexts.size());
    for (std::size_t i = 0; i < machine.contexts.size(); ++i) {
        const gpu::DeviceReport& context = machine.contexts[i];
        text += fmt::format("{} {} {} ({}), OpenGL {}\n", context.chosen ? '*' : ' ', context.index, context.name,
                            context.type, context.api_version.empty() ? "none" : context.api_version);
        for (const std::string& reason : context.reasons) text += fmt::format("      not chosen: {}\n", reason);
    }
    text += fmt::format("\nvulkan:    {}", machine.vulkan.works ? "works" : "does not work");
    if (machine.vulkan.milliseconds > 0) text += fmt::format(" ({:.0f} ms)", machine.vulkan.milliseconds);
    text += ": " + machine.vulkan.detail + '\n';
    for (std::size_t i = 0; i < machine.opengl.size(); ++i)
        text += fmt::format("opengl {}:  {} ({:.0f} ms): {}\n", machine.contexts[i].index,
                            machine.opengl[i].works ? "works" : "does not work", machine.opengl[i].milliseconds,
                            machine.opengl[i].detail);
    for (const std::string& message : machine.validation) text += fmt::format("           validation: {}\n", message);
    return text + fmt::format("reference: works on {} CPU threads\n", machine.threads);
}

Json as_json(const Machine& machine)
{
    std::vector<Json> devices;
    for (const gpu::DeviceReport& d : machine.devices)
        devices.push_back(Json::object({{"index", d.index},
                                        {"name", d.name},
                                        {"kind", name(d.kind)},
                                        {"type", d.type},
                                        {"driver", d.driver},
                                        {"api_version", d.api_version},
                                        {"memory", d.memory},
                                        {"chosen", d.chosen},
                                        {"reasons", d.reasons}}));
    const gpu::ProbeResult& probe = machine.vulkan;
    const Json vulkan = Json::object({{"name", "vulkan"},
                                      {"works", probe.works},
                                      {"milliseconds", probe.milliseconds},
                                      {"detail", probe.detail},
                                      {"validation", machine.validation}});
    std::vector<Json> contexts;
    for (std::size_t i = 0; i < machine.contexts.size(); ++i)
        contexts.push_back(Json::object({{"index", machine.contexts[i].index},
                                         {"name", machine.contexts[i].name},
                                         {"version", machine.contexts[i].api_version},
                                         {"chosen", machine.contexts[i].chosen},
                                         {"reasons", machine.contexts[i].reasons},
                                         {"works", machine.opengl[i].works},
                                         {"milliseconds", machine.opengl[i].milliseconds},
                                         {"detail", machine.opengl[i].detail}}));
    const Json opengl = Json::object({{"name", "opengl"}, {"works", machine.opengl_works()}, {"contexts", contexts}});
    const Json reference = Json::object({{"name", "reference"}, {"works", true}, {"threads", machine.threads}});
    return Json::object({{"schema", "etalon-info/1"},
                         {"versions", machine.versions},
                         {"devices", devices},
                         {"backends", std::vector<Json>{vulkan, opengl, reference}}});
}

}  // namespace

int info(const Arguments& arguments)
{
    if (!arguments.positional().empty()) return scene_info(arguments);
    const Machine machine = examine(device_options(arguments));
    put(arguments.has("json") ? as_json(machine).text() + "\n" : as_text(machine));
    return machine.works() ? 0 : static_cast<int>(Blame::machine);
}

}  // namespace etalon::cli
