#pragma once
// A file that has its name only when it is whole: written as NAME.part, synced, then renamed.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace pentaprism {

/// One process at a time: a second one is refused while the first lives. Every call throws Error(kOutput), "NAME:
/// cannot write (what the system said)". Destroyed before commit(), it removes its .part.
class PartFile {
  public:
    explicit PartFile(const std::filesystem::path& file);
    ~PartFile();
    PartFile(const PartFile&) = delete;
    PartFile& operator=(const PartFile&) = delete;

    void write(const void* bytes, std::size_t count);
    std::uint64_t position();
    void seek(std::uint64_t position);

    /// Everything written so far is on the disk after this, under the final name.
    void commit();

    /// The first failure is kept and thrown again here: for writers whose own clean-up swallows exceptions.
    void throw_if_failed() const;
    const std::filesystem::path& name() const { return file_; }

  private:
    [[noreturn]] void fail(int system_error);

    struct Close {
        void operator()(std::FILE* stream) const { std::fclose(stream); }
    };
    std::filesystem::path file_, part_;
    std::unique_ptr<std::FILE, Close> stream_;
    std::string failure_;
    int lock_ = -1;
};

}  // namespace pentaprism
