// RFC 1952 and 1950, by zlib.
#include <rlslab/input/formats/gzip.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <zlib.h>

namespace rlslab {
namespace {

class Unpacker {
    ByteSource packed_;
    std::string name_;
    std::array<char, 1 << 15> in_{};
    z_stream stream_{};
    bool gzip_;
    enum class At { start, within, behind } at_ = At::start;  // of, in, or behind a part

    [[noreturn]] void fail(std::string const& what) const { throw InputError(name_ + ": " + what); }
    bool refill() {
        std::size_t const got = packed_(in_);
        stream_.next_in = reinterpret_cast<Bytef*>(in_.data());
        stream_.avail_in = uInt(got);
        return got > 0;
    }
    /// Behind a part: another, zeros that fill up a tape's block, or the end.
    bool another() {
        if (!gzip_ && (stream_.avail_in > 0 || refill()))
            fail("expected compressed data to end, found something behind them");
        while (stream_.avail_in > 0 || refill()) {
            if (*stream_.next_in == 0x1f) return true;
            if (*stream_.next_in != 0)
                fail("expected the compressed data to end the file, found something behind them");
            ++stream_.next_in, --stream_.avail_in;
        }
        return false;
    }

public:
    Unpacker(ByteSource packed, std::string name, bool gzip)
        : packed_(std::move(packed)), name_(std::move(name)), gzip_(gzip) {
        constexpr int gzip_alone = 16;
        if (inflateInit2(&stream_, (gzip ? gzip_alone : 0) + MAX_WBITS) != Z_OK) throw std::bad_alloc();
    }
    Unpacker(Unpacker const&) = delete;
    Unpacker& operator=(Unpacker const&) = delete;
    ~Unpacker() { inflateEnd(&stream_); }

    std::size_t read(std::span<char> to) {
        std::size_t const most = std::min<std::size_t>(to.size(), 1 << 30);
        stream_.next_out = reinterpret_cast<Bytef*>(to.data());
        stream_.avail_out = uInt(most);
        while (stream_.avail_out == most && most > 0) {
            if (at_ == At::behind && !another()) return 0;
            if (at_ == At::behind) inflateReset(&stream_);
            if (stream_.avail_in == 0 && !refill()) fail("the compressed data end too early (was the file cut short?)");
            at_ = At::within;
            int const code = inflate(&stream_, Z_NO_FLUSH);
            if (code == Z_MEM_ERROR) throw std::bad_alloc();
            if (code == Z_STREAM_END) at_ = At::behind;
            else if (code != Z_OK && code != Z_BUF_ERROR)
                fail(std::string("the compressed data are damaged") +
                     (stream_.msg ? std::string(" (") + stream_.msg + ')' : ""));
        }
        return most - stream_.avail_out;
    }
};

ByteSource unpacked(ByteSource packed, std::string name, bool gzip) {
    return [unpacker = std::make_shared<Unpacker>(std::move(packed), std::move(name), gzip)](std::span<char> to) {
        return unpacker->read(to);
    };
}

}  // namespace

ByteSource unpacked(ByteSource packed, std::string name) { return unpacked(std::move(packed), std::move(name), true); }
ByteSource inflated(ByteSource packed, std::string name) { return unpacked(std::move(packed), std::move(name), false); }

}  // namespace rlslab
