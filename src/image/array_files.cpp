// Two formats that data sets are read with: NumPy's .npy (format 1.0, as NumPy's manual defines it) and Middlebury's
// .flo (Baker et al. 2011, A Database and Evaluation Methodology for Optical Flow). Both are a few bytes and the
// numbers.

#include <bit>
#include <cstdint>
#include <fmt/format.h>
#include <pentaprism/image.h>

#include "image/part_file.h"

namespace pentaprism {
namespace {

static_assert(std::endian::native == std::endian::little, "both formats are written as numbers lie in memory");

// The planes' values pixel by pixel.
std::vector<float> interleaved(int width, int height, std::span<const DataPlane> planes) {
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<float> values(pixels * planes.size());
    for (std::size_t p = 0; p < planes.size(); ++p)
        for (std::size_t i = 0; i < pixels; ++i) values[i * planes.size() + p] = planes[p].values[i];
    return values;
}

void write_values(PartFile& part, const std::vector<float>& values) {
    part.write(values.data(), values.size() * sizeof(float));
}

}  // namespace

void write_npy(const std::filesystem::path& file, int width, int height, std::span<const DataPlane> planes) {
    const std::string shape = planes.size() == 1 ? fmt::format("({}, {})", height, width)
                                                 : fmt::format("({}, {}, {})", height, width, planes.size());
    std::string header = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': {}, }}", shape);
    // Magic, version and length are 10 bytes; the whole is padded to a multiple of 64 and ends in a new line.
    header.append(63 - (10 + header.size()) % 64, ' ');
    header += '\n';
    const auto length = static_cast<std::uint16_t>(header.size());
    PartFile part(file);
    part.write("\x93NUMPY\x01\x00", 8);
    part.write(&length, sizeof length);
    part.write(header.data(), header.size());
    write_values(part, interleaved(width, height, planes));
    part.commit();
}

void write_flo(const std::filesystem::path& file, int width, int height, const DataPlane& u, const DataPlane& v) {
    const std::int32_t size[2] = {width, height};
    PartFile part(file);
    part.write("PIEH", 4);
    part.write(size, sizeof size);
    const DataPlane planes[2] = {u, v};
    write_values(part, interleaved(width, height, planes));
    part.commit();
}

}  // namespace pentaprism
