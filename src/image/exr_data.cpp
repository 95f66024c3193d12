#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <new>
#include <pentaprism/error.h>
#include <pentaprism/image.h>

#include "image/exr_stream.h"

namespace pentaprism {

void write_data_exr(const std::filesystem::path& file, int width, int height, std::span<const DataPlane> planes,
                    const FileMetadata& metadata) {
    Imf::Header header(width, height, 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
    Imf::FrameBuffer buffer;
    for (const DataPlane& plane : planes) {
        const Imf::PixelType type = plane.whole_number ? Imf::UINT : Imf::FLOAT;
        header.channels().insert(plane.name, Imf::Channel(type));
        buffer.insert(plane.name, Imf::Slice::Make(type, plane.values.data(), Imath::V2i(0, 0), width, height));
    }
    header.insert("software", Imf::StringAttribute(metadata.software));
    if (!metadata.settings_json.empty()) header.insert("pentaprism", Imf::StringAttribute(metadata.settings_json));
    PartFile part(file);
    PartStream stream(part);
    try {
        Imf::OutputFile output(stream, header);
        output.setFrameBuffer(buffer);
        output.writePixels(height);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        part.throw_if_failed();
        throw Error(ErrorKind::kOutput, fmt::format("{}: cannot write ({})", file.string(), error.what()));
    }
    part.throw_if_failed();  // closing writes the table of line offsets, and is silent about failures
    part.commit();
}

}  // namespace pentaprism
