// LDR-FLIP, by the paper that perceived.hpp names. All filters are products of one for
// rows and one for columns. Arithmetic is float +, -, *, / and square roots alone, so that the CPU does not
// matter.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <optional>
#include <vector>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/core/workers.hpp"
#include "corda/golden/perceived.hpp"

namespace corda {
namespace {

constexpr int kStripeRows = 64;  // 32: a quarter slower; 128: too few for several threads of small pictures
constexpr double kPi = std::numbers::pi;

// The paper on final errors: exponents and the point that splits the range of errors.
constexpr float kColorExponent = 0.7F;
constexpr float kSplitColor = 0.4F;
constexpr float kSplitError = 0.95F;
constexpr double kFeatureWidthDegrees = 0.082;

// linear sRGB to XYZ, each divided by that of white: its rows have the sum 1.
constexpr std::array<double, 3> kOfX{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794};
constexpr std::array<double, 3> kOfY{2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897};
constexpr std::array<double, 3> kOfZ{1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382};

struct Matrix {
    std::array<std::array<float, 3>, 3> to_xyz{};
    std::array<std::array<float, 3>, 3> to_rgb{};
};

Matrix make_matrix() {
    std::array<std::array<double, 3>, 3> m{kOfX, kOfY, kOfZ};
    for (auto& row : m) {
        const double sum = row[0] + row[1] + row[2];
        for (double& entry : row) entry /= sum;
    }
    Matrix result;
    const auto minor = [&](std::size_t i, std::size_t j) {
        const std::size_t r = (i + 1) % 3;
        const std::size_t s = (i + 2) % 3;
        const std::size_t c = (j + 1) % 3;
        const std::size_t d = (j + 2) % 3;
        return m[r][c] * m[s][d] - m[r][d] * m[s][c];
    };
    const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            result.to_xyz[i][j] = static_cast<float>(m[i][j]);
            result.to_rgb[j][i] = static_cast<float>(minor(i, j) / determinant);
        }
    }
    return result;
}

/// Linear light of an sRGB byte.
std::array<float, 256> make_linear() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double c = static_cast<double>(i) / 255.0;
        table[i] = static_cast<float>(c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92);
    }
    return table;
}

using Kernel = std::vector<float>;  // of 2 radius + 1 weights

/// The rows' or columns' part of a filter, by the offset from its middle.
template <class Weight>
std::vector<double> weights_of(int radius, Weight weight) {
    std::vector<double> weights;
    for (int i = -radius; i <= radius; ++i) weights.push_back(weight(static_cast<double>(i)));
    return weights;
}

double sum_of(const std::vector<double>& weights) {
    double sum = 0.0;
    for (const double weight : weights) sum += weight;
    return sum;
}

Kernel scaled(const std::vector<double>& weights, double factor) {
    Kernel kernel;
    for (const double weight : weights) kernel.push_back(static_cast<float>(weight * factor));
    return kernel;
}

/// Positive weights sum to 1, negative ones to -1.
Kernel balanced(std::vector<double> weights) {
    double positive = 0.0;
    double negative = 0.0;
    for (const double weight : weights) (weight > 0.0 ? positive : negative) += weight;
    for (double& weight : weights) weight /= weight > 0.0 ? positive : -negative;
    return scaled(weights, 1.0);
}

/// The filters of an observer.
struct Filters {
    int radius = 0;
    int feature_radius = 0;
    Kernel a, rg, by1, by2, by1_columns, by2_columns;  ///< contrast sensitivity
    Kernel blur, edge, point;                          ///< features
};

Filters make_filters(double ppd) {
    Filters filters;
    constexpr double kWidest = 0.04;
    filters.radius = static_cast<int>(std::ceil(3.0 * std::sqrt(kWidest / (2.0 * kPi * kPi)) * ppd));
    const auto gauss = [&](double b) {
        return weights_of(filters.radius,
                          [=](double i) { return std::exp(-kPi * kPi * (i / ppd) * (i / ppd) / b); });
    };
    const auto normalized = [](const std::vector<double>& weights) {
        return scaled(weights, 1.0 / sum_of(weights));
    };
    filters.a = normalized(gauss(0.0047));
    filters.rg = normalized(gauss(0.0053));
    // A sum of two products.
    const std::vector<double> first = gauss(0.04);
    const std::vector<double> second = gauss(0.025);
    const double first_part = 34.1 * std::sqrt(kPi / 0.04);
    const double second_part = 13.5 * std::sqrt(kPi / 0.025);
    const double all =
        first_part * sum_of(first) * sum_of(first) + second_part * sum_of(second) * sum_of(second);
    filters.by1 = scaled(first, 1.0);
    filters.by2 = scaled(second, 1.0);
    filters.by1_columns = scaled(first, first_part / all);
    filters.by2_columns = scaled(second, second_part / all);
    const double sd = 0.5 * kFeatureWidthDegrees * ppd;
    filters.feature_radius = static_cast<int>(std::ceil(3.0 * sd));
    const auto bell = [sd](double i) { return std::exp(-i * i / (2.0 * sd * sd)); };
    filters.blur = normalized(weights_of(filters.feature_radius, bell));
    filters.edge = balanced(weights_of(filters.feature_radius, [&](double i) { return -i * bell(i); }));
    filters.point = balanced(
        weights_of(filters.feature_radius, [&](double i) { return (i * i / (sd * sd) - 1.0) * bell(i); }));
    return filters;
}

float cube_root(float x) {
    // A third of the exponent; two steps of Halley leave the rounding alone.
    const auto third =
        static_cast<std::int32_t>(static_cast<float>(std::bit_cast<std::int32_t>(x)) * (1.0F / 3.0F));
    float y = std::bit_cast<float>(third + 709921077);
    for (int i = 0; i < 2; ++i) {
        const float cube = y * y * y;
        y = y * (cube + 2.0F * x) / (2.0F * cube + x);
    }
    return y;
}

/// x^y for x > 0, |y log2 x| < 126.
float power(float x, float y) {
    const std::int32_t bits = std::bit_cast<std::int32_t>(x);
    const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;
    const float mantissa = std::bit_cast<float>(bits - (exponent << 23));  // sqrt(1/2) .. sqrt(2)
    const float t = (mantissa - 1.0F) / (mantissa + 1.0F);
    const float s = t * t;
    const float series = 1.0F + s * (1.0F / 3 + s * (1.0F / 5 + s * (1.0F / 7 + s * (1.0F / 9))));
    const float log2 = static_cast<float>(exponent) + 2.88539008F * t * series;
    const float z = y * log2;
    const auto whole = static_cast<std::int32_t>(z + (z < 0.0F ? -0.5F : 0.5F));
    const float u = (z - static_cast<float>(whole)) * std::numbers::ln2_v<float>;
    const float e =
        1.0F +
        u * (1.0F + u * (1.0F / 2 + u * (1.0F / 6 + u * (1.0F / 24 + u * (1.0F / 120 + u * (1.0F / 720))))));
    return e * std::bit_cast<float>((whole + 127) << 23);
}

/// L*, and a* and b* that Hunt's effect has adjusted.
struct Lab {
    float l, a, b;
};

Lab hunt_lab(float x, float y, float z) {
    const auto f = [](float t) {
        constexpr float kDelta = 6.0F / 29.0F;
        const float line = t / (3.0F * kDelta * kDelta) + 4.0F / 29.0F;
        return t > kDelta * kDelta * kDelta ? cube_root(t) : line;
    };
    const float fy = f(y);
    const float l = 116.0F * fy - 16.0F;
    return {l, 0.01F * l * (500.0F * (f(x) - fy)), 0.01F * l * (200.0F * (fy - f(z)))};
}

float hyab(const Lab& u, const Lab& v) {
    const float da = u.a - v.a;
    const float db = u.b - v.b;
    return std::abs(u.l - v.l) + std::sqrt(da * da + db * db);
}

/// The largest error of colours: of green and blue.
float largest_error(const Matrix& matrix) {
    const auto lab = [&](std::size_t c) {
        return hunt_lab(matrix.to_xyz[0][c], matrix.to_xyz[1][c], matrix.to_xyz[2][c]);
    };
    return power(hyab(lab(1), lab(2)), kColorExponent);
}

/// Constants that do not depend on the pictures.
struct Constants {
    Filters filters;
    Matrix matrix = make_matrix();
    std::array<float, 256> linear = make_linear();
    float largest = largest_error(matrix);
    int reach = 0;
};

/// Rows of one part of a picture, filtered along rows: A, RG, BY twice, and three of features.
constexpr std::size_t kParts = 7;

/// The sums of kernel[k] * rows[k][x].
CORDA_AVX2_CLONES void add_rows(const Kernel& kernel, const float* const* rows, int count, float* out) {
    for (int x = 0; x < count; ++x) out[x] = 0.0F;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
        const float weight = kernel[k];
        const float* const row = rows[k];
        for (int x = 0; x < count; ++x) out[x] += weight * row[x];
    }
}

/// One picture in a stripe of columns x0 .. x1: the last rows, filtered along rows.
class Filtered {
  public:
    Filtered(const Constants& constants, const Image& image, int x0, int x1)
        : constants_(constants),
          image_(image),
          x0_(x0),
          count_(x1 - x0),
          depth_(2 * constants.reach + 1),
          opponent_(3 * stride()),
          ring_(kParts * static_cast<std::size_t>(depth_) * static_cast<std::size_t>(count_)),
          out_(8 * static_cast<std::size_t>(count_)),
          taps_(static_cast<std::size_t>(depth_)) {}

    /// Row `y`, or the nearest that the picture has.
    void add(int y) {
        read(std::clamp(y, 0, image_.height() - 1));
        const Filters& f = constants_.filters;
        const std::array<std::pair<const Kernel*, int>, kParts> parts{
            {{&f.a, 0}, {&f.rg, 1}, {&f.by1, 2}, {&f.by2, 2}, {&f.blur, 0}, {&f.edge, 0}, {&f.point, 0}}};
        for (std::size_t part = 0; part < kParts; ++part) {
            const auto& [kernel, plane] = parts[part];
            const int radius = static_cast<int>(kernel->size()) / 2;
            const float* const in = opponent_.data() + static_cast<std::size_t>(plane) * stride();
            for (std::size_t k = 0; k < kernel->size(); ++k)
                taps_[k] = in + constants_.reach - radius + static_cast<int>(k);
            add_rows(*kernel, taps_.data(), count_, slot(part, y));
        }
    }

    /// Filters along columns around row `y`.
    void finish(int y) {
        const Filters& f = constants_.filters;
        columns(f.a, 0, y, 0);
        columns(f.rg, 1, y, 1);
        columns(f.by1_columns, 2, y, 2);
        columns(f.by2_columns, 3, y, 3);
        columns(f.blur, 5, y, 4);   // edges across
        columns(f.edge, 4, y, 5);   // and along rows
        columns(f.blur, 6, y, 6);   // points across
        columns(f.point, 4, y, 7);  // and along rows
    }

    /// Which of the eight results of finish().
    [[nodiscard]] const float* result(std::size_t which) const {
        return out_.data() + which * static_cast<std::size_t>(count_);
    }

  private:
    [[nodiscard]] std::size_t stride() const {
        return static_cast<std::size_t>(count_) + 2 * static_cast<std::size_t>(constants_.reach);
    }

    [[nodiscard]] float* slot(std::size_t part, int y) {
        const int row = ((y % depth_) + depth_) % depth_;
        return ring_.data() + (part * static_cast<std::size_t>(depth_) + static_cast<std::size_t>(row)) *
                                  static_cast<std::size_t>(count_);
    }

    void columns(const Kernel& kernel, std::size_t part, int y, std::size_t which) {
        const int radius = static_cast<int>(kernel.size()) / 2;
        for (std::size_t k = 0; k < kernel.size(); ++k)
            taps_[k] = slot(part, y - radius + static_cast<int>(k));
        add_rows(kernel, taps_.data(), count_, out_.data() + which * static_cast<std::size_t>(count_));
    }

    /// The row in opponent colours Y Cx Cz, with the columns that the filters reach beside. Y is 0 .. 1.
    void read(int y) {
        const auto& m = constants_.matrix.to_xyz;
        float* const planes = opponent_.data();
        const std::size_t size = stride();
        for (std::size_t i = 0; i < size; ++i) {
            const int x = std::clamp(x0_ - constants_.reach + static_cast<int>(i), 0, image_.width() - 1);
            const std::uint8_t* const rgba = image_.pixel(x, y);
            const float r = constants_.linear[rgba[0]];
            const float g = constants_.linear[rgba[1]];
            const float b = constants_.linear[rgba[2]];
            const float luminance = m[1][0] * r + m[1][1] * g + m[1][2] * b;
            planes[i] = luminance;
            planes[size + i] = m[0][0] * r + m[0][1] * g + m[0][2] * b - luminance;
            planes[2 * size + i] = luminance - (m[2][0] * r + m[2][1] * g + m[2][2] * b);
        }
    }

    const Constants& constants_;
    const Image& image_;
    int x0_;
    int count_;
    int depth_;
    std::vector<float> opponent_;
    std::vector<float> ring_;
    std::vector<float> out_;
    std::vector<const float*> taps_;
};

/// The colours of a pixel as an observer perceives them.
Lab perceived(const Matrix& matrix, float y, float cx, float cz) {
    const float x = y + cx;
    const float z = y - cz;
    std::array<float, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto& row = matrix.to_rgb[c];
        rgb[c] = std::clamp(row[0] * x + row[1] * y + row[2] * z, 0.0F, 1.0F);
    }
    const auto component = [&](std::size_t i) {
        return matrix.to_xyz[i][0] * rgb[0] + matrix.to_xyz[i][1] * rgb[1] + matrix.to_xyz[i][2] * rgb[2];
    };
    return hunt_lab(component(0), component(1), component(2));
}

/// The error of a pixel by those of colour and features.
float combined(float distance, float feature, float largest) {
    const float error = distance > 0.0F ? power(distance, kColorExponent) : 0.0F;
    const float split = kSplitColor * largest;
    const float color = error < split
                            ? kSplitError / split * error
                            : kSplitError + (error - split) / (largest - split) * (1.0F - kSplitError);
    if (color <= 0.0F) return 0.0F;
    return power(std::min(color, 1.0F), 1.0F - std::sqrt(std::min(feature, 1.0F)));
}

CORDA_AVX2_CLONES void row_errors(const Constants& constants, const Filtered& a, const Filtered& b, int count,
                                  float* errors) {
    const auto length = [](float u, float v) { return std::sqrt(u * u + v * v); };
    for (int x = 0; x < count; ++x) {
        const auto lab = [&](const Filtered& of) {
            return perceived(constants.matrix, of.result(0)[x], of.result(1)[x],
                             of.result(2)[x] + of.result(3)[x]);
        };
        const float distance = hyab(lab(a), lab(b));
        const float edge =
            std::abs(length(a.result(4)[x], a.result(5)[x]) - length(b.result(4)[x], b.result(5)[x]));
        const float point =
            std::abs(length(a.result(6)[x], a.result(7)[x]) - length(b.result(6)[x], b.result(7)[x]));
        const float feature = std::max(edge, point) / std::numbers::sqrt2_v<float>;
        errors[x] = combined(distance, feature, constants.largest);
    }
}

/// The columns in which rows y0 .. y1 differ; empty if they do not.
std::optional<std::pair<int, int>> differing_columns(const Image& a, const Image& b, int y0, int y1) {
    int first = a.width();
    int last = -1;
    for (int y = std::max(y0, 0); y < std::min(y1, a.height()); ++y) {
        if (std::memcmp(a.pixel(0, y), b.pixel(0, y), a.row_bytes()) == 0) continue;
        const auto differs = [&](int x) { return std::memcmp(a.pixel(x, y), b.pixel(x, y), 4) != 0; };
        int x = 0;
        while (x < first && !differs(x)) ++x;
        first = std::min(first, x);
        x = a.width() - 1;
        while (x > last && !differs(x)) --x;
        last = std::max(last, x);
    }
    if (last < 0) return std::nullopt;
    return std::pair(first, last + 1);
}

/// The sum of the errors in rows y0 .. y1.
double stripe_sum(const Constants& constants, const Image& a, const Image& b, int y0, int y1) {
    const int reach = constants.reach;
    const auto columns = differing_columns(a, b, y0 - reach, y1 + reach);
    if (!columns) return 0.0;
    const int x0 = std::max(columns->first - reach, 0);
    const int x1 = std::min(columns->second + reach, a.width());
    Filtered of_a(constants, a, x0, x1);
    Filtered of_b(constants, b, x0, x1);
    std::vector<float> errors(static_cast<std::size_t>(x1 - x0));
    double sum = 0.0;
    for (int y = y0 - reach; y < y1 + reach; ++y) {
        of_a.add(y);
        of_b.add(y);
        const int done = y - reach;
        if (done < y0) continue;
        of_a.finish(done);
        of_b.finish(done);
        row_errors(constants, of_a, of_b, x1 - x0, errors.data());
        for (const float error : errors) sum += static_cast<double>(error);
    }
    return sum;
}

double opaque_flip(const Image& a, const Image& b, int threads, double ppd) {
    Constants constants{.filters = make_filters(ppd)};
    constants.reach = std::max(constants.filters.radius, constants.filters.feature_radius);
    const int stripes = (a.height() + kStripeRows - 1) / kStripeRows;
    std::vector<double> sums(static_cast<std::size_t>(stripes));
    std::atomic<int> next = 0;
    std::atomic<bool> stops = false;
    const auto work = [&] {
        for (int i = next++; i < stripes && !stops; i = next++) {
            check_cancelled();
            const int y0 = i * kStripeRows;
            sums[static_cast<std::size_t>(i)] =
                stripe_sum(constants, a, b, y0, std::min(y0 + kStripeRows, a.height()));
        }
    };
    {
        const auto helpers = start_threads(std::min(threads, stripes) - 1, work);
        try {
            work();
        } catch (...) {
            stops = true;
            throw;
        }
    }
    double sum = 0.0;
    for (const double part : sums) sum += part;
    return sum / (static_cast<double>(a.width()) * a.height());
}

bool is_opaque(const Image& image) {
    for (std::size_t i = 3; i < image.size_bytes(); i += 4)
        if (image.data()[i] != 255) return false;
    return true;
}

/// The picture over a grey of that level.
Image laid_over(Image image, int level) {
    for (std::size_t i = 0; i < image.size_bytes(); i += 4) {
        std::uint8_t* const rgba = image.data() + i;
        for (int c = 0; c < 3; ++c)
            rgba[c] = static_cast<std::uint8_t>((rgba[c] * rgba[3] + level * (255 - rgba[3]) + 127) / 255);
        rgba[3] = 255;
    }
    return image;
}

}  // namespace

double flip(const Image& a, const Image& b, int threads, double pixels_per_degree) {
    if (a.rect() != b.rect()) throw Error(ExitCode::kUsage, "FLIP is of two pictures of one size");
    if (a.size_bytes() == 0) return 0.0;
    if (is_opaque(a) && is_opaque(b)) return opaque_flip(a, b, threads, pixels_per_degree);
    double largest = 0.0;
    for (const int level : {0, 255})
        largest = std::max(largest,
                           opaque_flip(laid_over(a, level), laid_over(b, level), threads, pixels_per_degree));
    return largest;
}

}  // namespace corda
