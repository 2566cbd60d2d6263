// Many filters of one kind on a GPU, with the CPU's bits.
#pragma once

#include <rlslab/core/records.hpp>
#include <rlslab/gpu/driver.hpp>
#include <rlslab/gpu/team.hpp>
#include <rlslab/many/fleet_steps.hpp>

namespace rlslab::gpu {

/// Rows that are in the GPU's memory: psi of filter i, parameter j and row k at psi[i psi_filter + j psi_parameter +
/// k psi_row], y at y[i y_filter + k y_row].
template <class T>
struct RowsThere {
    T const *psi, *y;
    Index rows;
    Index psi_filter, psi_parameter, psi_row, y_filter, y_row;
};

/// M filters F on a GPU, where F is ud, ud_delta, conventional, carlson, gentleman, qr or inverse_qr over float or
/// double, such as Ud<double>, of 1 to 32 parameters. Each keeps the bits of F on its own rows while its health is not
/// nonfinite: after that other numbers may be NaN than there. A sample with a number that is not finite is missing, as
/// of rlslab::Fleet, and so is what health(i) says. All filters have one problem.
///
/// Memory: bytes_per_filter() and 5 bytes a filter; an update waits for copies of the host's rows. What reads a result
/// waits for it. Throws std::runtime_error, in one sentence, where there is no GPU or it fails.
template <class F>
class Fleet {
public:
    using scalar = typename F::scalar;
    using T = scalar;
    static constexpr std::string_view name = F::name;
    static constexpr unsigned team_threads = 128;  ///< of 128, 256 and 512 the fastest (H200)
    static constexpr bool has_teams = name == "ud" || name == "ud_delta" || name == "conventional";

    /// Throws std::invalid_argument unless filters >= 1 and the problem has 1 to 32 parameters, and as F.
    Fleet(Index filters, Problem<T> const& problem)
        : fresh_(problem), filters_(filters), size_(Index(fresh_.theta().size())) {
        expects(1 <= filters && filters <= std::numeric_limits<Index>::max() / (1 << 20), "filters >= 1");
        expects(size_ <= 32, "1 to 32 parameters on a GPU");
        detail::RecordSize<T> counted;
        detail::pieces_of(fresh_, counted);
        words_ = counted.packs;
        driver::start();
        records_ = Memory<T>(size_t(groups() * words_ * tile()));
        health_ = Memory<unsigned char>(size_t(filters));
        missing_ = Memory<unsigned>(size_t(filters));
        begin();
    }

    Index filters() const { return filters_; }  ///< M
    Index parameters() const { return size_; }  ///< d
    Index rows() const { return rows_; }        ///< that each filter was shown
    Index bytes_per_filter() const { return words_ * Index(sizeof(T)); }

    /// R rows for each filter, in order, one launch: psi is M x d R, the columns of row k from k d on; y is M x R.
    /// Throws std::invalid_argument unless they are.
    void update(Eigen::Ref<Matrix<T> const> const& psi, Eigen::Ref<Matrix<T> const> const& y) {
        Index const R = y.cols();
        expects(psi.rows() == filters_ && y.rows() == filters_ && R >= 1 && psi.cols() == size_ * R,
                "psi: filters x parameters; y: a number for each filter");
        T const* const there[] = {copied(psi, psi_), copied(y, y_)};
        update(RowsThere<T>{there[0], there[1], R, 1, filters_, filters_ * size_, 1, filters_});
    }
    /// The same of rows that are there already. They must stay until wait(), or until what follows on the GPU's default
    /// stream.
    void update(RowsThere<T> const& rows) {
        expects(records_.size() > 0 && rows.rows >= 1, "a fleet that was not moved from, and rows");
        upload();
        detail::LaneRows<T> in{records_.data(),    rows.psi,     rows.y,        health_.data(), missing_.data(),
                               filters_,           rows.rows,    size_,         words_,         rows.psi_filter,
                               rows.psi_parameter, rows.psi_row, rows.y_filter, rows.y_row};
        detail::LaneWriting<T> constants(in.constants, 1);
        detail::constants_of(fresh_, constants);
        std::string kernel = "rlslab_" + std::string(name) + (sizeof(T) == 8 ? "_double_" : "_float_");
        Index const lanes = size_ <= 16 ? 16 : 32, together = is_team() ? team_threads / lanes : team_threads;
        if (is_team()) {
            Index const of_record = name == "conventional" ? 0 : words_;
            in.room = lanes == 16 ? detail::team_room<16>(of_record) : detail::team_room<32>(of_record);
            kernel += "team_" + std::to_string(lanes) + "_" + std::to_string(size_ == lanes ? lanes : 0);
        } else kernel += std::to_string(size_);
        driver::launch(driver::kernel(kernel), size_t((filters_ + together - 1) / together), team_threads,
                       size_t(together * in.room) * sizeof(T), &in);
        rows_ += rows.rows;
    }
    void wait() const { driver::wait(); }

    /// M x d: row i is the theta of filter i.
    Matrix<T> thetas() const {
        Matrix<T> out(filters_, size_);
        each([&](Index i, F& one) { out.row(i) = one.theta().transpose(); });
        return out;
    }
    Health health(Index i) const { return Health(one_of(health_, i)); }
    std::vector<Health> healths() const {
        std::vector<unsigned char> codes = all_of(health_);
        std::vector<Health> out(codes.size());
        for (size_t i = 0; i < codes.size(); ++i) out[i] = Health(codes[i]);
        return out;
    }
    /// Samples of filter i, or of all.
    FleetCounts counts(Index i) const {
        Index const missing = one_of(missing_, i);
        return {rows_ - missing, missing};
    }
    FleetCounts counts() const {
        FleetCounts out{rows_ * filters_, 0};
        for (unsigned const missing : all_of(missing_)) out.missing += missing, out.taken -= missing;
        return out;
    }

    /// Filter i as a filter of its own, with its bits on all rows to come; only the gain of the last row is lost.
    F filter(Index i) const {
        check(i);
        upload();
        std::vector<T> tile(size_t(words_ * this->tile()));
        records_.read(size_t(i / this->tile()) * tile.size(), tile.data(), tile.size());
        F out = fresh_;
        detail::LaneReading<T> from(tile.data() + i % this->tile(), this->tile());
        detail::pieces_of(out, from);
        return out;
    }
    /// And back: filter i goes on as this one, of the fleet's size and forgetting; counts stay. Its health is sound,
    /// or undetermined where theta is not finite. Throws std::invalid_argument for another.
    void put(Index i, F const& one) {
        check(i);
        expects(Index(one.theta().size()) == size_, "a filter of the fleet's size");
        F written = one;
        T of_one[4] = {}, of_all[4] = {};
        detail::LaneWriting<T> one_to(of_one, 1), all_to(of_all, 1);
        detail::constants_of(written, one_to), detail::constants_of(fresh_, all_to);
        expects(std::equal(of_one, of_one + 4, of_all), "a filter of the fleet's forgetting");
        upload();
        std::vector<T> tile(size_t(words_ * this->tile()));
        size_t const first = size_t(i / this->tile()) * tile.size();
        records_.read(first, tile.data(), tile.size());
        detail::LaneWriting<T> to(tile.data() + i % this->tile(), this->tile());
        detail::pieces_of(written, to);
        records_.write(first, tile.data(), tile.size());
        auto const health =
            static_cast<unsigned char>(Vector<T>(one.theta()).allFinite() ? Health::sound : Health::undetermined);
        health_.write(size_t(i), &health, 1);
    }
    /// look(i, filter) for all, some megabytes at a time.
    template <class Look>
    void each(Look const& look) const {
        upload();
        Index const of_group = words_ * tile(), some = std::max<Index>(1, (Index(1) << 20) / of_group);
        std::vector<T> held(size_t(some * of_group));
        F one = fresh_;
        for (Index g = 0; g < groups(); g += some) {
            Index const here = std::min(some, groups() - g);
            records_.read(size_t(g * of_group), held.data(), size_t(here * of_group));
            for (Index i = g * tile(); i < std::min((g + here) * tile(), filters_); ++i) {
                Index const in = i - g * tile();
                detail::LaneReading<T> from(held.data() + in / tile() * of_group + in % tile(), tile());
                detail::pieces_of(one, from);
                look(i, one);
            }
        }
    }
    /// All filters begin anew, also where a state was loaded.
    void reset() { rows_ = 0, host_ = {}, host_is_newer_ = false, begin(); }

    static constexpr std::string_view layer = "gpu_fleet";
    static std::array<StateOption, 1> options(auto const& f) { return {{{"filters", double(f.filters_)}}}; }
    static auto state(auto& f) {  // through the host: downloaded to be seen, uploaded again before the next use
        f.download();
        if constexpr (!std::is_const_v<std::remove_reference_t<decltype(f)>>) f.host_is_newer_ = true;
        return std::tie(f.fresh_, f.host_.records, f.host_.health, f.host_.missing, f.rows_);
    }

private:
    struct Host {
        std::vector<T> records;
        std::vector<Health> health;
        std::vector<unsigned> missing;
    };
    mutable F fresh_;
    Index filters_, size_, words_ = 0, rows_ = 0;
    mutable Memory<T> records_;
    mutable Memory<unsigned char> health_;
    mutable Memory<unsigned> missing_;
    Memory<T> psi_, y_;
    mutable Host host_;
    mutable bool host_is_newer_ = false;

    bool is_team() const { return has_teams && size_ > 8; }
    Index tile() const { return is_team() ? 1 : detail::lanes_a_tile; }
    Index groups() const { return (filters_ + tile() - 1) / tile(); }
    void check(Index i) const { expects(0 <= i && i < filters_, "the number of a filter that is there"); }
    void begin() {
        Index const of_group = words_ * tile(), some = std::max<Index>(1, (Index(1) << 20) / of_group);
        std::vector<T> held(size_t(some * of_group));
        for (Index n = 0; n < some * tile(); ++n) {
            detail::LaneWriting<T> to(held.data() + n / tile() * of_group + n % tile(), tile());
            detail::pieces_of(fresh_, to);
        }
        for (Index g = 0; g < groups(); g += some)
            records_.write(size_t(g * of_group), held.data(), size_t(std::min(some, groups() - g) * of_group));
        Health const first = Vector<T>(fresh_.theta()).allFinite() ? Health::sound : Health::undetermined;
        health_.write(0, std::vector<unsigned char>(size_t(filters_), (unsigned char)(first)).data(), size_t(filters_));
        missing_.write(0, std::vector<unsigned>(size_t(filters_), 0).data(), size_t(filters_));
    }
    template <class X>
    X one_of(Memory<X> const& memory, Index i) const {
        check(i);
        upload();
        X out{};
        memory.read(size_t(i), &out, 1);
        return out;
    }
    template <class X>
    std::vector<X> all_of(Memory<X> const& memory) const {
        upload();
        std::vector<X> out(memory.size());
        memory.read(0, out.data(), out.size());
        return out;
    }
    T const* copied(Eigen::Ref<Matrix<T> const> const& rows, Memory<T>& to) {
        if (rows.outerStride() != rows.rows()) return copied(Matrix<T>(rows), to);
        if (to.size() < size_t(rows.size())) to = Memory<T>(size_t(rows.size()));
        to.write(0, rows.data(), size_t(rows.size()));
        return to.data();
    }
    void download() const { host_ = {all_of(records_), healths(), all_of(missing_)}; }
    void upload() const {
        if (!host_is_newer_) return void(host_ = {});
        host_is_newer_ = false;
        records_.write(0, host_.records.data(), host_.records.size());
        std::vector<unsigned char> codes;
        for (Health const health : host_.health) codes.push_back((unsigned char)(health));
        health_.write(0, codes.data(), codes.size());
        missing_.write(0, host_.missing.data(), host_.missing.size());
        host_ = {};
    }
};

}  // namespace rlslab::gpu
