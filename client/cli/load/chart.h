// Line charts as SVG for a page that has their colours and sizes in its style (html_report.cc), and
// those of a run (run_charts.cc).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "client/cli/load/results.h"

namespace arap::cli {

struct ChartAxis {
  std::string title;
  double low = 0, high = 1;  // low < high; of a logarithmic one above 0
  bool logarithmic = false;
  std::vector<std::pair<double, std::string>> ticks;  // those outside are not drawn
};

struct ChartSeries {
  std::string name;
  int style = 1;  // 1 to 4: a colour and a pattern of the line, so that no one has to tell colours
  std::vector<std::pair<double, double>> points;  // by x; NaN of y breaks the line
  bool marks = false;                             // a circle at each point
};

// A stretch of x that shows `tip` where the pointer is on it.
struct ChartBand {
  double from = 0, to = 0;
  std::string tip;
};

struct Chart {
  std::string title;        // what is seen, for those who do not see it too
  std::string description;  // a sentence with the most important figures, for them
  ChartAxis x, y;
  std::vector<ChartSeries> series;
  std::vector<ChartBand> bands;
  // A line across, such as a limit or a rate that was found; its name is written beside it.
  std::vector<std::pair<double, std::string>> at_x, at_y;
};

// An axis from 0 up to `highest` or a little beyond, with round numbers.
ChartAxis CountAxis(std::string title, double highest);
// An axis from 0 to so many seconds since the beginning, in minutes where those are many.
ChartAxis SecondsAxis(double highest);
// A logarithmic axis of microseconds around both times.
ChartAxis MicrosAxis(std::string title, double lowest, double highest);
// A logarithmic axis of 1 / (1 - q), for quantiles q of so many values: every further nine is as wide.
ChartAxis QuantileAxis(double count);

// A legend and the picture. `id` is one that no other chart of the page has.
std::string ChartHtml(const Chart& chart, std::string_view id);

// Median, p99 and slowest response of each interval; the run has some.
Chart TimesChart(const LoadResults& results, Operation operation);
// Offered, answered and, if any, failed messages a second of each interval; the run has some.
Chart RatesChart(const LoadResults& results, Operation operation);
// Which part of the answers took how long, where each further nine of the part is as wide.
Chart QuantilesChart(const LoadResults& results, Operation operation);
// Median and p99 of the steps of a ramp or search by their rate; the run has some.
Chart StepsChart(const LoadResults& results);

// For text between tags and in attributes.
std::string EscapeHtml(std::string_view text);

}  // namespace arap::cli
