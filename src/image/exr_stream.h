#pragma once
// OpenEXR's output stream on a file that has its name only when it is whole.

#include <ImfIO.h>
#include <cstdint>

#include "image/part_file.h"

namespace pentaprism {

class PartStream : public Imf::OStream {
  public:
    explicit PartStream(PartFile& file) : OStream(file.name().c_str()), file_(file) {}
    void write(const char bytes[], int count) override { file_.write(bytes, static_cast<std::size_t>(count)); }
    uint64_t tellp() override { return file_.position(); }
    void seekp(uint64_t position) override { file_.seek(position); }

  private:
    PartFile& file_;
};

}  // namespace pentaprism
