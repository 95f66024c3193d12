#include "lab/machine.h"

#include <fmt/format.h>
#include <fstream>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "base/cpu.h"
#include "base/parallel.h"

namespace pentaprism {
namespace {

// The value of the first line `key : value` (/proc/cpuinfo) or `key: value` (/proc/self/status); empty without one.
std::string value_in(const char* file, const std::string& key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (line.rfind(key, 0) != 0) continue;
        const std::size_t colon = line.find(':');
        if (colon == std::string::npos) continue;
        const std::size_t first = line.find_first_not_of(" \t", colon + 1);
        return first == std::string::npos ? "" : line.substr(first);
    }
    return "";
}

std::string compiler_name() {
#if defined(__clang__)
    return "Clang " __clang_version__;
#elif defined(__GNUC__)
    return "GCC " __VERSION__;
#else
    return "an unknown compiler";
#endif
}

}  // namespace

BenchMachine this_machine() {
    BenchMachine machine;
    machine.cpu = value_in("/proc/cpuinfo", "model name");
    utsname names{};
    if (uname(&names) == 0) {
        machine.system = fmt::format("{} {} {}", names.sysname, names.release, names.machine);
        if (machine.cpu.empty()) machine.cpu = names.machine;
    }
    machine.isa = isa_name(cpu_isa());
    machine.compiler = compiler_name();
    machine.processors = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
    machine.threads = thread_count();
    machine.memory_gb = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e9;
    return machine;
}

void reset_peak_memory() {
#ifdef __GLIBC__
    malloc_trim(0);  // what earlier work has given back is not this work's memory
#endif
    std::ofstream("/proc/self/clear_refs") << "5";
}

std::int64_t peak_memory() {
    const std::string kilobytes = value_in("/proc/self/status", "VmHWM");
    if (!kilobytes.empty()) return std::stoll(kilobytes) * 1024;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;  // Linux counts kilobytes
}

}  // namespace pentaprism
