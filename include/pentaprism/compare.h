#pragma once
// How far apart two pictures are, in the measures that people quote.

#include <pentaprism/render.h>
#include <vector>

namespace pentaprism {

struct CompareOptions {
    /// rmse, psnr and max of linear values as they are, instead of sRGB-encoded values cut to [0, 1]. SSIM and FLIP are
    /// about what an eye sees on a screen: always sRGB.
    bool linear = false;
};

struct Comparison {
    int width = 0, height = 0;
    double rmse = 0.0;  ///< root of the mean squared difference over R, G, B
    double psnr = 0.0;  ///< dB, -20 log10(rmse): 1 is the peak; +infinity for equal pictures
    double ssim = 1.0;  ///< mean structural similarity of luma; 1: equal (Wang, Bovik, Sheikh, Simoncelli 2004)
    double flip = 0.0;  ///< mean LDR FLIP at 67 pixels a degree; 0: equal (Andersson et al. 2020)
    double max = 0.0;   ///< largest difference of a channel
    std::int64_t not_finite = 0;  ///< values that are NaN or infinite in one picture; each counts as a difference of 1
    std::vector<float> flip_map;  ///< FLIP of each pixel, row by row from the top
};

/// Colours alone count, alpha and depth do not. Throws Error(kUsage) if the sizes differ or are 0.
Comparison compare_pictures(const Picture& a, const Picture& b, const CompareOptions& options = {});

/// |a - b| of the encoded values times `gain`, as a linear picture that a PNG without tone curve shows as just that.
Picture difference_picture(const Picture& a, const Picture& b, double gain);

}  // namespace pentaprism
