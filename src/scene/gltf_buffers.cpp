// Buffers and buffer views (glTF 2.0, 3.6), with EXT_meshopt_compression
// (https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_meshopt_compression).

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "scene/gltf_document.h"

namespace pentaprism::gltf {

namespace {

constexpr const char* kMeshopt = "EXT_meshopt_compression";
constexpr std::size_t kLargestDecoded = std::size_t{1} << 32;

/// A buffer that only says how long its uncompressed contents would be; nothing is there to be read.
bool is_placeholder(const Object& buffer) {
    return buffer.has_extension(kMeshopt) && buffer.extension(kMeshopt).boolean("fallback", false);
}

void read_buffer(Document& document, std::size_t i) {
    const Object buffer = document.item("buffers", "buffer", i);
    const std::size_t length = buffer.required_size("byteLength");
    if (length == 0) buffer.fail("has a byteLength of 0");
    std::vector<std::uint8_t>& bytes = document.buffers[i].bytes;
    document.buffers[i].length = length;
    if (buffer.has("uri")) {
        const std::string uri = buffer.text("uri");
        UriBytes data = read_uri(document, uri);
        const std::string shown = uri.starts_with("data:") ? "data URI" : "\"" + uri + "\"";
        if (!data.problem.empty()) buffer.fail(fmt::format("cannot be read: {} {}", shown, data.problem));
        bytes = std::move(data.bytes);
    } else if (is_placeholder(buffer)) {
        return;
    } else if (i == 0 && document.has_binary_chunk) {
        bytes = std::move(document.binary_chunk);
    } else {
        // The specification leaves the data of such a buffer to the application: we have none, and say so when it is
        // read.
        if (i == 0 && document.is_binary) buffer.fail("has no uri, and the file has no binary chunk");
        return;
    }
    if (bytes.size() < length)
        buffer.fail(fmt::format("has {} bytes of the {} that byteLength promises", bytes.size(), length));
    bytes.resize(length);
}

View range_of_buffer(const Document& document, const Object& view) {
    if (!view.has("buffer")) view.fail("has no buffer");
    const Index index = view.index("buffer", "buffers");
    const std::size_t offset = view.size("byteOffset", 0), length = view.required_size("byteLength");
    const Document::Buffer& buffer = document.buffers[static_cast<std::size_t>(index)];
    if (length == 0) view.fail("has a byteLength of 0");
    if (offset + length > buffer.length) {
        view.fail(fmt::format("reads past its buffer {} (byte {} of {})", index, offset + length, buffer.length));
    }
    if (buffer.bytes.empty()) return {{}, length, 0};
    return {std::span(buffer.bytes).subspan(offset, length), length, 0};
}

void apply_filter(const Object& meshopt, const std::string& filter, std::vector<std::uint8_t>& bytes, std::size_t count,
                  std::size_t stride) {
    if (filter == "NONE") return;
    if (filter == "OCTAHEDRAL") {
        if (stride != 4 && stride != 8) meshopt.fail(fmt::format("has filter OCTAHEDRAL with a stride of {}", stride));
        meshopt_decodeFilterOct(bytes.data(), count, stride);
    } else if (filter == "QUATERNION") {
        if (stride != 8) meshopt.fail(fmt::format("has filter QUATERNION with a stride of {}", stride));
        meshopt_decodeFilterQuat(bytes.data(), count, stride);
    } else if (filter == "EXPONENTIAL") {
        if (stride % 4 != 0) meshopt.fail(fmt::format("has filter EXPONENTIAL with a stride of {}", stride));
        meshopt_decodeFilterExp(bytes.data(), count, stride);
    } else {
        meshopt.fail(fmt::format("has an unknown filter \"{}\"", filter));
    }
}

std::vector<std::uint8_t> decode_meshopt(const Document& document, const Object& view) {
    const Object meshopt = view.extension(kMeshopt);
    const View source = range_of_buffer(document, meshopt);
    if (source.absent()) meshopt.fail("is in a buffer without data");
    const auto data = source.bytes;
    const std::size_t stride = meshopt.required_size("byteStride"), count = meshopt.required_size("count");
    const std::string mode = meshopt.text("mode");
    if (stride == 0 || stride > 256 || count > kLargestDecoded / stride) {
        meshopt.fail(fmt::format("has {} elements with a stride of {}", count, stride));
    }
    // The encoders never gain more than this; a larger claim is a broken or hostile file.
    if (count * stride / 4096 > data.size())
        meshopt.fail(fmt::format("says {} bytes are packed into {}", count * stride, data.size()));
    document.spend(count * stride / 4);
    std::vector<std::uint8_t> bytes(count * stride);
    int result = -1;
    if (mode == "ATTRIBUTES") {
        if (stride % 4 != 0) meshopt.fail(fmt::format("has mode ATTRIBUTES with a stride of {}", stride));
        result = meshopt_decodeVertexBuffer(bytes.data(), count, stride, data.data(), data.size());
    } else if (mode == "TRIANGLES" || mode == "INDICES") {
        if (stride != 2 && stride != 4) meshopt.fail(fmt::format("has mode {} with a stride of {}", mode, stride));
        if (mode == "TRIANGLES" && count % 3 != 0)
            meshopt.fail(fmt::format("has mode TRIANGLES with {} indices", count));
        result = mode == "TRIANGLES"
                     ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, data.data(), data.size())
                     : meshopt_decodeIndexSequence(bytes.data(), count, stride, data.data(), data.size());
    } else {
        meshopt.fail(fmt::format("has an unknown mode \"{}\"", mode));
    }
    if (result != 0) meshopt.fail("holds data that cannot be decoded");
    if (mode == "ATTRIBUTES") apply_filter(meshopt, meshopt.text("filter", "NONE"), bytes, count, stride);
    return bytes;
}

}  // namespace

void read_buffers(Document& document) {
    document.buffers.resize(document.count("buffers"));
    for (std::size_t i = 0; i < document.buffers.size(); ++i) read_buffer(document, i);

    const std::size_t count = document.count("bufferViews");
    document.views.resize(count);
    document.decompressed.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Object view = document.item("bufferViews", "buffer view", i);
        const std::size_t stride = view.size("byteStride", 0);
        if (view.has("byteStride") && (stride < 4 || stride > 252))
            view.fail(fmt::format("has a byteStride of {}", stride));
        if (view.has_extension(kMeshopt)) {
            document.decompressed[i] = decode_meshopt(document, view);
            document.views[i] = {document.decompressed[i], document.decompressed[i].size(), stride};
        } else {
            document.views[i] = range_of_buffer(document, view);
            document.views[i].stride = stride;
        }
    }
}

}  // namespace pentaprism::gltf
