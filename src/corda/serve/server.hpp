#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"

namespace corda::serve {

/// A request that has passed the checks of a Server.
struct Request {
    bool is_post = false;
    std::string path;  ///< after the token: "frame/30.png"; empty for the page itself
    std::map<std::string, std::string, std::less<>> query;
    std::string body;
};

struct Response {
    unsigned status = 200;
    std::string type = "application/json";
    std::string body;
};

/// A response whose body is a text for a person.
[[nodiscard]] Response text_response(unsigned status, std::string text);

/// A part of a page, in UTF-8. `type`: "text/html".
[[nodiscard]] Response page_response(std::string_view type, std::string_view text);

/// Whether a Host header, "localhost:8000", names this machine or one of `others`; the port is not compared.
[[nodiscard]] bool is_known_host(std::string_view host, std::span<const std::string> others);

/// Whether a text can be the token of an address: 16 .. 128 letters, digits, "-" and "_".
[[nodiscard]] bool is_token(std::string_view text);

/// The text that stands for a port in addresses: that of the last server of this user at the port, so that
/// pages that are open find the next one. It is kept in the folder `XDG_RUNTIME_DIR`, which no other user can
/// read; random if there is none, or for port 0.
[[nodiscard]] std::string token_of_port(std::uint16_t port);

struct ServerDef {
    std::uint16_t port = 0;               ///< 0: any that is free
    std::vector<std::string> hosts = {};  ///< names other than localhost by which browsers reach the server
    std::string bind = "127.0.0.1";  ///< the IPv4 or IPv6 address that it listens at; "0.0.0.0", "::": all
    std::string token = {};          ///< see is_token(); empty: token_of_port()
};

/// A web server for one person. It answers requests that know its token and name this machine or one of
/// `hosts` as their host and their origin, so that neither other users nor pages of other sites can use it.
/// Pages of these hosts alone may show its pages in a frame.
class Server : NonCopyable {
  public:
    /// Answers one request on a thread of its own, within half a minute.
    using Handler = std::function<Response(const Request&)>;

    /// Throws corda::Error: kIo if the port cannot be used, kUsage for a definition out of its ranges.
    Server(const ServerDef& def, Handler handler);
    /// Waits for the requests that are being answered.
    ~Server();

    /// Where the page is: "http://127.0.0.1:8000/0123456789abcdef0123456789abcdef/".
    [[nodiscard]] const std::string& address() const;
    /// The same with the names of `hosts`; none if the server listens at this machine alone.
    [[nodiscard]] std::vector<std::string> other_addresses() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace corda::serve
