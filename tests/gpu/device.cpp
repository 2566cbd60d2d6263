// The checks and times of fleets on a GPU, for ./lab gpu:
//   gpu_device check FORM [FILTERS [ROWS]]     each size of either arithmetic beside the library's filters
//   gpu_device digests on|off                  what tests/gpu/digests.txt has, of a GPU or of the library's filters
//   gpu_device bench FORM SECONDS [SIZE]       a table of times, from a size on
#include "tests/gpu/compared.hpp"

#include <rlslab/gpu/driver.hpp>

#include <cstdio>
#include <cstdlib>

using namespace rlslab::gpu;

namespace {

int check(std::string_view form, long M, long rows) {
    long different = 0, count = 0;
    for (int d : {1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 16, 20, 32})
        for (bool is_double : {false, true}) {
            Compared const is = compared(form, is_double, d, M, rows);
            ++count, different += is.different > 0;
            if (is.different > 0)
                std::printf("%s %s %d: %ld filters differ, first %ld\n", form.data(), is_double ? "double" : "float", d,
                            is.different, is.first);
        }
    for (auto const& [d, is_double] : {std::pair{4, true}, {12, false}, {32, true}})
        for (std::string const& what : lost_on_the_way(form, is_double, d))
            std::printf("%s %d: %s is lost on the way\n", form.data(), d, what.c_str()), ++different;
    if (form == "qr" || form == "gentleman")
        for (int d : {4, 16}) ++count, different += compared(form, true, d, M, rows, false).different > 0;
    std::printf("%s: %ld compared, %ld different (%ld filters, %ld rows)\n", form.data(), count, different, M, rows);
    return different > 0;
}
int digests(bool on_gpu) {
    int wrong = 0;
    for (std::string_view form : forms)
        for (int d : {4, 8, 16})
            for (bool is_double : {false, true}) {
                Compared const is = compared(form, is_double, d, 128, 200, true, on_gpu);
                wrong += is.different > 0;
                if (is.different > 0) continue;
                std::printf("%s %s %d %016lx\n", form.data(), is_double ? "double" : "float", d, is.digest);
            }
    return wrong > 0;
}
int bench(std::string_view form, double seconds, int least) {
    bool const is_h200 = driver::device_name().find("H200") != std::string::npos;
    double const rate = is_h200 ? 4.8e12 : 3.35e12;  // of the data sheet
    for (bool is_double : {false, true})
        for (int d : {4, 8, 16, 32}) {
            if (d < least) continue;
            Timed one{};
            for (auto const& [log2_M, rows] : {std::pair{20, 1}, {22, 1}, {d > 16 ? 18 : d > 8 ? 19 : 20, 64}}) {
                if (log2_M == 22 && d > 8) continue;
                Timed const is = timed(form, is_double, d, 1L << log2_M, rows, seconds);
                if (log2_M == 20 && rows == 1) one = is;
                std::printf("%-12s %-6s %2d parameters, 2^%d filters, %2d rows: %8.4f ns, %5.3f of the limit",
                            form.data(), is_double ? "double" : "float", d, log2_M, rows, is.ns,
                            is.bytes / rate * 1e9 / is.ns);
                if (rows > 1) std::printf(", %5.3f of one row's time", is.ns / one.ns);
                std::printf("\n"), std::fflush(stdout);
            }
        }
    return 0;
}

}  // namespace

int main(int argc, char** argv) try {
    std::string const verb = argc > 1 ? argv[1] : "", of = argc > 2 ? argv[2] : "";
    if (verb == "check" && argc > 2)
        return check(of, argc > 3 ? std::atol(argv[3]) : 4096, argc > 4 ? std::atol(argv[4]) : 300);
    if (verb == "digests" && argc > 2) return digests(of == "on");
    if (verb == "bench" && argc > 3) return bench(of, std::atof(argv[3]), argc > 4 ? std::atoi(argv[4]) : 0);
    if (verb == "name") return std::puts(driver::device_name().c_str()) < 0;
    std::printf("gpu_device check FORM [FILTERS [ROWS]] | digests on|off | bench FORM SECONDS | name\n");
    return 2;
} catch (std::exception const& failure) {
    std::printf("%s\n", failure.what());
    return 3;
}
