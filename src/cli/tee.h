#pragma once
// One picture to several files, with the time that they cost.

#include <chrono>
#include <memory>
#include <pentaprism/image.h>
#include <vector>

#include "cli/interrupt.h"

namespace pentaprism::cli {

class Tee : public RowSink {
  public:
    Tee(const std::vector<std::filesystem::path>& files, const ImageSettings& image, const FileMetadata& metadata) {
        for (const auto& file : files) writers_.push_back(make_picture_writer(file, image, metadata));
    }
    void begin(const FrameInfo& info) override {
        for_each_writer([&](PictureWriter& writer) { writer.begin(info); });
    }
    void rows(const PixelRows& band) override {
        for_each_writer([&](PictureWriter& writer) { writer.rows(band); });
    }
    /// Gives the files their names, unless a signal came.
    void finish() {
        throw_if_interrupted();
        for_each_writer([&](PictureWriter& writer) { writer.finish(); });
    }
    double milliseconds() const { return milliseconds_; }

  private:
    template <class Body>
    void for_each_writer(const Body& body) {
        const auto start = std::chrono::steady_clock::now();
        for (const auto& writer : writers_) body(*writer);
        milliseconds_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    }
    std::vector<std::unique_ptr<PictureWriter>> writers_;
    double milliseconds_ = 0.0;
};

}  // namespace pentaprism::cli
