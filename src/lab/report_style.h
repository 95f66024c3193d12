#pragma once
// The style sheet and the script of the HTML report: inline, so that the page is one file and needs no network.

#include <string>

namespace pentaprism {

/// Colours of plots for this many methods included.
std::string report_style(int methods);

/// Sorts and filters tables, lights one method up in all plots. The page says everything without it.
std::string report_script();

}  // namespace pentaprism
