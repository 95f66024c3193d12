#include "gl/pass.h"

namespace pentaprism::gl {

void set_uniforms(const Program& program, const PassData& data, const Region& region, int count) {
    const View& view = data.frame.view;
    const PixelRect& p = region.pixels;
    program.set("region", p.x0, p.x1, p.y0, p.y1);
    program.set("region_cell", region.cell_x, region.cell_y);
    program.set("region_cell_columns", region.cell_columns);
    program.set("pass_slots", count);
    program.set("samples_per_pixel", data.table.spp());
    program.set("sample_seed", data.table.seed());
    program.set("thresholds_over_time", OpacityPattern(data.table).over_time ? 1 : 0);
    program.set("w_near", view.w_near());
    program.set("lens_ratio", view.lens.ratio);
    program.set("z_near", static_cast<float>(view.depth_near));
    program.set("z_far", static_cast<float>(view.depth_far));
    program.set("picture_width", view.width);
    program.set("picture_height", view.height);
    program.set("orthographic", view.perspective ? 0 : 1);
}

}  // namespace pentaprism::gl
