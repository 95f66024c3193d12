// The outside of a glTF file: text or binary container (glTF 2.0, section 4), URIs, files beside it.

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <pentaprism/error.h>

#include "scene/gltf_document.h"

namespace pentaprism::gltf {

namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kChunkJson = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kChunkBin = 0x004E4942;   // "BIN"

/// Empty problem: the whole file is in `bytes`.
UriBytes read_whole_file(const fs::path& file) {
    std::error_code code;
    if (fs::is_directory(file, code)) return {{}, "is a folder"};
    errno = 0;
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) return {{}, errno != 0 ? std::strerror(errno) : "cannot be opened"};
    const std::streamoff size = stream.tellg();
    if (size < 0) return {{}, "cannot be read"};
    UriBytes result;
    result.bytes.resize(static_cast<std::size_t>(size));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(result.bytes.data()), size);
    if (stream.gcount() != size) return {{}, "cannot be read to its end"};
    return result;
}

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
    return std::uint32_t(bytes[at]) | std::uint32_t(bytes[at + 1]) << 8 | std::uint32_t(bytes[at + 2]) << 16 |
           std::uint32_t(bytes[at + 3]) << 24;
}

/// The JSON text within a .glb; its first binary chunk goes into the document.
std::span<const std::uint8_t> split_binary(std::span<const std::uint8_t> bytes, Document& document) {
    if (bytes.size() < 20) document.fail(fmt::format("a binary glTF of {} bytes ends within its header", bytes.size()));
    if (word(bytes, 4) != 2)
        document.fail(fmt::format("binary glTF version {} is not supported, only 2 is", word(bytes, 4)));
    const std::size_t length = word(bytes, 8);
    if (length > bytes.size())
        document.fail(fmt::format("the header says {} bytes but the file has {}", length, bytes.size()));
    if (length < bytes.size())
        document.warn(fmt::format("{} bytes after the end of the glTF are ignored", bytes.size() - length));
    if (length < 20) document.fail(fmt::format("the header says a length of {} bytes, which holds no JSON", length));

    std::span<const std::uint8_t> json;
    bool first = true;
    for (std::size_t at = 12; at < length;) {
        if (at + 8 > length) document.fail(fmt::format("the chunk header at byte {} is cut off", at));
        const std::size_t size = word(bytes, at);
        const std::uint32_t type = word(bytes, at + 4);
        at += 8;
        if (size > length - at)
            document.fail(
                fmt::format("the chunk at byte {} has {} bytes but only {} are left", at - 8, size, length - at));
        const auto chunk = bytes.subspan(at, size);
        if (first && type != kChunkJson) document.fail("the first chunk is not JSON");
        if (!first && type == kChunkJson) document.fail("there is a second JSON chunk");
        if (first) {
            json = chunk;
        } else if (type == kChunkBin) {
            if (document.has_binary_chunk) document.fail("there is a second binary chunk");
            document.has_binary_chunk = true;
            document.binary_chunk.assign(chunk.begin(), chunk.end());
        }
        first = false;
        at += size;
    }
    return json;
}

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;
    if (c == '/' || c == '_') return 63;
    return -1;
}

UriBytes decode_base64(std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    UriBytes result;
    result.bytes.reserve(text.size() * 3 / 4);
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : text) {
        const int digit = base64_digit(c);
        if (digit < 0) return {{}, "is not base64"};
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        held += 6;
        if (held >= 8) {
            held -= 8;
            result.bytes.push_back(static_cast<std::uint8_t>(bits >> held & 0xFF));
        }
    }
    if (held >= 6) return {{}, "is cut off"};
    return result;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string percent_decoded(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0) {
            result.push_back(static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2])));
            i += 2;
        } else {
            result.push_back(text[i]);
        }
    }
    return result;
}

UriBytes decode_data_uri(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos) return {{}, "has no data"};
    const std::string_view kind = uri.substr(0, comma), data = uri.substr(comma + 1);
    if (kind.ends_with(";base64")) return decode_base64(data);
    const std::string text = percent_decoded(data);
    return {{text.begin(), text.end()}, ""};
}

}  // namespace

UriBytes read_uri(const Document& document, const std::string& uri) {
    if (uri.starts_with("data:")) return decode_data_uri(uri);
    if (uri.find("://") != std::string::npos) return {{}, "is not a local file"};
    const std::string decoded = percent_decoded(uri);
    if (decoded.find('\0') != std::string::npos) return {{}, "is not a file name"};
    UriBytes result = read_whole_file(document.folder / fs::path(decoded));
    // A name that really holds a percent sign.
    if (!result.problem.empty() && decoded != uri && uri.find('\0') == std::string::npos) {
        UriBytes verbatim = read_whole_file(document.folder / fs::path(uri));
        if (verbatim.problem.empty()) return verbatim;
    }
    return result;
}

void read_container(const fs::path& file, Document& document) {
    document.name = file.filename().string();
    document.folder = file.parent_path();
    const UriBytes whole = read_whole_file(file);
    if (!whole.problem.empty()) throw Error(ErrorKind::kScene, file.string() + ": " + whole.problem);

    std::span<const std::uint8_t> json = whole.bytes;
    if (json.empty()) document.fail("is empty");
    document.is_binary = json.size() >= 4 && word(json, 0) == kMagic;
    if (document.is_binary)
        json = split_binary(json, document);
    else if (file.extension() == ".glb")
        document.fail("is not a binary glTF: it does not begin with \"glTF\"");
    try {
        document.json = Json::parse(json.begin(), json.end());
    } catch (const Json::exception& problem) {
        // Without the "[json.exception...]" in front.
        std::string what = problem.what();
        if (const auto end = what.find("] "); end != std::string::npos) what.erase(0, end + 2);
        document.fail("the JSON cannot be read: " + what);
    }
    if (!document.json.is_object()) document.fail("the JSON is not an object");
}

}  // namespace pentaprism::gltf
