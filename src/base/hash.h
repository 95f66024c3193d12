#pragma once
// XXH3, 128 bits (Collet): tells files apart and finds broken ones. No defence against whoever wants to deceive.

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

struct XXH3_state_s;

namespace pentaprism {

class Hash {
  public:
    Hash();
    void add(const void* bytes, std::size_t count);
    /// A file that cannot be read counts as empty.
    void add_file(const std::filesystem::path& file);
    /// 32 hexadecimal digits, as `xxh128sum` prints them.
    std::string hex() const;
    /// The same, high byte first.
    std::array<std::byte, 16> digest() const;

  private:
    struct Free {
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> state_;
};

}  // namespace pentaprism
