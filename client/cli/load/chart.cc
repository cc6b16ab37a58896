#include "client/cli/load/chart.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/load/metric.h"

namespace arap::cli {
namespace {

// In units of the picture, which is as wide as its place on the page.
constexpr double kPictureWidth = 480, kPictureHeight = 270;
constexpr double kLeft = 66, kRight = 464, kTop = 12, kBottom = 222;

double PlaceOn(const ChartAxis& axis, double value) {
  if (!axis.logarithmic) return (value - axis.low) / (axis.high - axis.low);
  return std::log(std::max(value, axis.low) / axis.low) / std::log(axis.high / axis.low);
}

double XOf(const Chart& chart, double value) {
  return kLeft + std::clamp(PlaceOn(chart.x, value), 0.0, 1.0) * (kRight - kLeft);
}

double YOf(const Chart& chart, double value) {
  return kBottom - std::clamp(PlaceOn(chart.y, value), 0.0, 1.0) * (kBottom - kTop);
}

bool IsOn(const ChartAxis& axis, double value) {
  const double slack = 1e-9 * (axis.high - axis.low);
  return value >= axis.low - slack && value <= axis.high + slack;
}

// The least of 1, 2 and 5 times a power of 10 that is `value` or more.
double RoundUp(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= value * (1 - 1e-9)) return step * power;
  }
  return 10 * power;
}

double RoundDown(double value) {
  const double power = std::pow(10, std::floor(std::log10(value) + 1e-9));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= value * (1 + 1e-9)) return step * power;
  }
  return power;
}

ChartAxis LinearAxis(std::string title, double highest) {
  ChartAxis axis{std::move(title), 0, 1, false, {}};
  if (!(highest > 0)) highest = 1;
  constexpr double kSteps = 5;
  const double step = RoundUp(highest / kSteps);
  axis.high = step * std::max(1.0, std::ceil(highest / step - 1e-9));
  for (double tick = 0; tick <= axis.high * (1 + 1e-9); tick += step) {
    axis.ticks.emplace_back(tick, fmt::format("{:.6g}", tick));
  }
  return axis;
}

std::string GridSvg(const Chart& chart) {
  std::string svg;
  for (const auto& [value, label] : chart.y.ticks) {
    if (!IsOn(chart.y, value)) continue;
    const double y = YOf(chart, value);
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{} {:.1f}H{}\"/><text class=\"y\" x=\"{}\" "
        "y=\"{:.1f}\">{}</text>\n",
        kLeft, y, kRight, kLeft - 6, y, EscapeHtml(label));
  }
  for (const auto& [value, label] : chart.x.ticks) {
    if (!IsOn(chart.x, value)) continue;
    const double x = XOf(chart, value);
    // A long label at the end of the axis would leave the picture.
    const bool last = x > kRight - 12 && label.size() > 3;
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{:.1f} {}V{}\"/><text class=\"{}\" x=\"{:.1f}\" "
        "y=\"{}\">{}</text>\n",
        x, kTop, kBottom + 4, last ? "end" : "x", last ? kRight + 12 : x, kBottom + 19,
        EscapeHtml(label));
  }
  svg += fmt::format("<path class=\"axis\" d=\"M{} {}V{}H{}\"/>\n", kLeft, kTop, kBottom, kRight);
  svg += fmt::format("<text class=\"title\" x=\"{}\" y=\"{}\">{}</text>\n", (kLeft + kRight) / 2,
                     kPictureHeight - 8, EscapeHtml(chart.x.title));
  return svg;
}

std::string SeriesSvg(const Chart& chart, const ChartSeries& series) {
  std::string path, marks;
  bool down = false;
  for (const auto& [x, y] : series.points) {
    if (!std::isfinite(y)) {
      down = false;
      continue;
    }
    const double at_x = XOf(chart, x), at_y = YOf(chart, y);
    path += fmt::format("{}{:.1f} {:.1f}", down ? "L" : "M", at_x, at_y);
    down = true;
    if (series.marks) {
      marks += fmt::format("<circle class=\"s{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"/>\n",
                           series.style, at_x, at_y);
    }
  }
  if (path.empty()) return {};
  // A point that stands alone is drawn as a dot by the round end of its line.
  return fmt::format("<path class=\"line s{}\" d=\"{}h0\"/>\n{}", series.style, path, marks);
}

std::string BandsSvg(const Chart& chart) {
  std::string svg;
  for (const ChartBand& band : chart.bands) {
    const double from = XOf(chart, band.from), to = XOf(chart, band.to);
    svg += fmt::format(
        "<rect class=\"band\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" "
        "height=\"{}\"><title>{}</title></rect>\n",
        from, kTop, std::max(to - from, 1.0), kBottom - kTop, EscapeHtml(band.tip));
  }
  return svg;
}

std::string AcrossSvg(const Chart& chart) {
  std::string svg;
  for (const auto& [value, name] : chart.at_x) {
    if (!IsOn(chart.x, value)) continue;
    const double x = XOf(chart, value);
    const bool left = x > (kLeft + kRight) / 2;
    svg += fmt::format(
        "<path class=\"limit\" d=\"M{0:.1f} {1}V{2}\"/><text class=\"note\" x=\"{3:.1f}\" "
        "y=\"{4}\" "
        "text-anchor=\"{5}\">{6}</text>\n",
        x, kTop, kBottom, x + (left ? -5 : 5), kTop + 12, left ? "end" : "start", EscapeHtml(name));
  }
  for (const auto& [value, name] : chart.at_y) {
    if (!IsOn(chart.y, value)) continue;
    const double y = YOf(chart, value);
    svg += fmt::format(
        "<path class=\"limit\" d=\"M{} {:.1f}H{}\"/><text class=\"note\" x=\"{}\" y=\"{:.1f}\" "
        "text-anchor=\"end\">{}</text>\n",
        kLeft, y, kRight, kRight - 4, y > kTop + 20 ? y - 5 : y + 14, EscapeHtml(name));
  }
  return svg;
}

}  // namespace

ChartAxis CountAxis(std::string title, double highest) {
  return LinearAxis(std::move(title), highest);
}

ChartAxis SecondsAxis(double highest) {
  if (highest <= 300) {
    ChartAxis axis = LinearAxis("seconds since the beginning", highest);
    axis.high = highest > 0 ? highest : 1;
    return axis;
  }
  ChartAxis axis = LinearAxis("minutes since the beginning", highest / 60);
  for (auto& [value, label] : axis.ticks) value *= 60;
  axis.high = highest;
  return axis;
}

ChartAxis MicrosAxis(std::string title, double lowest, double highest) {
  ChartAxis axis{std::move(title), 1, 10, true, {}};
  if (!(highest > 0)) highest = 10;
  if (!(lowest > 0)) lowest = highest;
  axis.low = RoundDown(lowest);
  axis.high = RoundUp(highest);
  if (axis.high <= axis.low) axis.high = RoundUp(axis.low * 1.5);
  // Within about a decade and a half every one of 1, 2, 5 has room, then 1 and so on.
  const double decades = std::log10(axis.high / axis.low);
  const int every = decades > 7 ? 2 : 1;
  for (int exponent = static_cast<int>(std::floor(std::log10(axis.low) + 1e-9));
       std::pow(10, exponent) <= axis.high * 1.001; ++exponent) {
    for (const double step : {1.0, 2.0, 5.0}) {
      if (decades > 2.5 && step > 1) continue;
      if (exponent % every != 0) continue;
      const double micros = step * std::pow(10, exponent);
      const auto [divisor, unit] = micros < 999     ? std::pair(1.0, "µs")
                                   : micros < 999e3 ? std::pair(1e3, "ms")
                                                    : std::pair(1e6, "s");
      axis.ticks.emplace_back(micros, fmt::format("{:.4g} {}", micros / divisor, unit));
    }
  }
  return axis;
}

ChartAxis QuantileAxis(double count) {
  ChartAxis axis{"percent of the answers that were no slower", 1, 10, true, {}};
  axis.high = std::max(100.0, count);
  axis.ticks = {{1, "0"}, {2, "50"}, {10, "90"}};
  std::string label = "99";
  for (double at = 100; at <= axis.high; at *= 10) {
    axis.ticks.emplace_back(at, label);
    label += label == "99" ? ".9" : "9";
  }
  return axis;
}

std::string ChartHtml(const Chart& chart, std::string_view id) {
  std::string html = "<ul class=\"legend\">";
  for (const ChartSeries& series : chart.series) {
    html += fmt::format(
        "<li><svg viewBox=\"0 0 30 8\" aria-hidden=\"true\"><path class=\"line s{}\" "
        "d=\"M1 4H29\"/></svg>{}</li>",
        series.style, EscapeHtml(series.name));
  }
  html += fmt::format(
      "</ul>\n<svg class=\"chart\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-labelledby=\"{2}-t "
      "{2}-d\"><title id=\"{2}-t\">{3}</title><desc id=\"{2}-d\">{4}</desc>\n",
      kPictureWidth, kPictureHeight, id, EscapeHtml(chart.title), EscapeHtml(chart.description));
  html += GridSvg(chart);
  html += AcrossSvg(chart);
  for (const ChartSeries& series : chart.series) html += SeriesSvg(chart, series);
  return html + BandsSvg(chart) + "</svg>\n";
}

std::string EscapeHtml(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

}  // namespace arap::cli
