// Twin of Lens::coc() of camera/lens.h: the signed circle of confusion at a depth, a radius in pixels times w.

uniform double lens_a, lens_b;
uniform bool lens_straight, lens_has_range, view_perspective;
uniform double lens_range_from, lens_range_to, lens_foreground, depth_near;

// A radius on the screen and how it changes with depth.
dvec2 smooth_step(double x, double width) {
    if (!(width > 0.0lf) || x >= width) return dvec2(1.0lf, 0.0lf);
    double s = max(x, 0.0lf) / width;
    return dvec2(s * s * (3.0lf - 2.0lf * s), 6.0lf * s * (1.0lf - s) / width);
}

dvec2 outside_range(double z, dvec2 r) {
    if (z >= lens_range_from && z <= lens_range_to) return dvec2(0.0lf);
    double width = 0.25lf * (lens_range_to - lens_range_from);
    dvec2 share = z > lens_range_to ? smooth_step(z - lens_range_to, width) : smooth_step(lens_range_from - z, width);
    double direction = z > lens_range_to ? 1.0lf : -1.0lf;
    return dvec2(r.x * share.x, r.y * share.x + direction * r.x * share.y);
}

dvec2 radius_at(double z) {
    dvec2 r = view_perspective ? dvec2(lens_a / z + lens_b, -lens_a / (z * z)) : dvec2(lens_a + lens_b * z, lens_b);
    if (lens_has_range) r = outside_range(z, r);
    if (r.x < -lens_foreground) r = dvec2(-lens_foreground, 0.0lf);
    return r;
}

double lens_coc(double z) {
    if (lens_straight) return lens_a + lens_b * z;
    if (!view_perspective) return radius_at(z).x;
    if (z >= depth_near) return z * radius_at(z).x;
    dvec2 r = radius_at(depth_near);
    return depth_near * r.x + (z - depth_near) * (r.x + depth_near * r.y);
}
