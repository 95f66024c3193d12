#include "base/hash.h"

#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <vector>
#include <xxhash.h>

namespace pentaprism {

void Hash::Free::operator()(XXH3_state_s* state) const {
    XXH3_freeState(state);
}

Hash::Hash() : state_(XXH3_createState()) {
    XXH3_128bits_reset(state_.get());
}

void Hash::add(const void* bytes, std::size_t count) {
    XXH3_128bits_update(state_.get(), bytes, count);
}

void Hash::add_file(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::vector<char> buffer(1 << 20);
    while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), stream.gcount() > 0) {
        add(buffer.data(), static_cast<std::size_t>(stream.gcount()));
    }
}

std::string Hash::hex() const {
    const XXH128_hash_t value = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", value.high64, value.low64);
}

std::array<std::byte, 16> Hash::digest() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
    std::array<std::byte, 16> bytes;
    std::memcpy(bytes.data(), canonical.digest, bytes.size());
    return bytes;
}

}  // namespace pentaprism
