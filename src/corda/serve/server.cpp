#include "corda/serve/server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <optional>
#include <system_error>
#include <utility>

#include "corda/core/file.hpp"
#include "corda/core/text.hpp"

namespace corda::serve {
namespace {

constexpr std::size_t kMaxBodyBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxTokenBytes = 128;

std::string random_token() {
    std::array<unsigned char, 16> bytes{};
    if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
        throw Error(ExitCode::kTemporary, "the system gives no random numbers; try again");
    std::string token;
    for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
    return token;
}

/// Compares two texts in a time that does not depend on where they differ.
bool is_equal(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    unsigned difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
    return difference == 0;
}

/// The name in "Example.org:8000", in lower case.
std::string name_of(std::string_view host) {
    return lower(host.substr(0, host.find(':', host.starts_with('[') ? host.find(']') : 0)));
}

bool is_among(std::string_view name, std::span<const std::string> hosts) {
    return std::ranges::any_of(hosts, [&](const std::string& host) { return name_of(host) == name; });
}

/// Calls `use`, whose exceptions must not reach the C functions of libmicrohttpd.
template <class Use>
MHD_Result guarded(const Use& use) noexcept {
    try {
        return use();
    } catch (...) {
        return MHD_NO;  // closes the connection
    }
}

MHD_Result add_value(void* values, MHD_ValueKind, const char* name, const char* value) {
    return guarded([&] {
        auto& query = *static_cast<decltype(Request::query)*>(values);
        query[name] = value == nullptr ? "" : value;
        return MHD_YES;
    });
}

/// The body of a request so far.
struct Body {
    std::string text;
    bool is_too_long = false;
};

void free_body(void*, MHD_Connection*, void** body, MHD_RequestTerminationCode) {
    delete static_cast<Body*>(*body);
    *body = nullptr;
}

}  // namespace

Response text_response(unsigned status, std::string text) {
    return {status, "text/plain; charset=utf-8", std::move(text)};
}

Response page_response(std::string_view type, std::string_view text) {
    return {200, fmt::format("{}; charset=utf-8", type), std::string(text)};
}

bool is_known_host(std::string_view host, std::span<const std::string> others) {
    const std::string name = name_of(host);
    return name == "localhost" || name == "127.0.0.1" || name == "[::1]" || is_among(name, others);
}

bool is_token(std::string_view text) {
    constexpr std::size_t kMinBytes = 16;
    const auto fits = [](unsigned char c) { return c < 128 && (std::isalnum(c) || c == '-' || c == '_'); };
    return text.size() >= kMinBytes && text.size() <= kMaxTokenBytes && std::ranges::all_of(text, fits);
}

std::string token_of_port(std::uint16_t port) {
    std::string token = random_token();
    const char* const folder = std::getenv("XDG_RUNTIME_DIR");
    if (port == 0 || folder == nullptr || *folder != '/') return token;
    const std::string path = fmt::format("{}/corda-{}.token", folder, port);
    const Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600));
    struct ::stat info {};
    constexpr unsigned kOthers = 077;
    if (!file || ::fstat(file.get(), &info) != 0 || !S_ISREG(info.st_mode) || info.st_uid != ::geteuid() ||
        (info.st_mode & kOthers) != 0)
        return token;
    std::array<char, kMaxTokenBytes + 1> kept{};
    const ssize_t length = ::pread(file.get(), kept.data(), kept.size(), 0);
    if (length > 0 && is_token({kept.data(), static_cast<std::size_t>(length)}))
        return {kept.data(), static_cast<std::size_t>(length)};
    if (::ftruncate(file.get(), 0) == 0) static_cast<void>(write_all(file.get(), token));
    return token;
}

struct Server::Impl {
    ServerDef def;
    Handler handler;
    std::string token;
    std::string address;
    std::string end_of_address;      ///< after the host
    std::vector<std::string> names;  ///< by which other machines reach it
    std::string policy;              ///< Content-Security-Policy
    MHD_Daemon* daemon = nullptr;

    [[nodiscard]] std::string header(MHD_Connection* connection, const char* name) const {
        const char* const value = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
        return value == nullptr ? "" : value;
    }

    /// The response to a request that is not for this page; checked before its body is read.
    [[nodiscard]] std::optional<Response> refusal(MHD_Connection* connection, std::string_view url,
                                                  std::string_view method) const {
        const std::string host = header(connection, "Host");
        if (!is_known_host(host, def.hosts))
            return text_response(403,
                                 fmt::format("'{}' is not this machine; behind a proxy of that name, start "
                                             "with --host {}\n",
                                             printable(host), printable(name_of(host))));
        const std::string origin = header(connection, "Origin");
        const std::size_t scheme_end = origin.find("://");
        const std::string origin_host =
            scheme_end == std::string::npos ? origin : origin.substr(scheme_end + 3);
        // A proxy may serve the page at any port of its own.
        if (!origin.empty() && lower(origin_host) != lower(host) &&
            !is_among(name_of(origin_host), def.hosts))
            return text_response(403,
                                 fmt::format("requests of the page of '{}' are refused; if this is the page "
                                             "behind a proxy of that name, start with --host {}\n",
                                             printable(origin), printable(name_of(origin_host))));
        if (url.size() < token.size() + 2 || !is_equal(url.substr(1, token.size()), token) ||
            url[token.size() + 1] != '/')
            return text_response(404, "there is no such page; take the address that the program printed\n");
        if (method != "GET" && method != "HEAD" && method != "POST")
            return text_response(405, "the methods are GET and POST\n");
        return std::nullopt;
    }

    [[nodiscard]] Response answer(MHD_Connection* connection, std::string_view url, std::string_view method,
                                  Body& body) const {
        if (body.is_too_long)
            return text_response(413, fmt::format("the request is over {} bytes long\n", kMaxBodyBytes));
        Request request;
        request.is_post = method == "POST";
        request.path = url.substr(token.size() + 2);
        request.body = std::move(body.text);
        MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, &add_value, &request.query);
        try {
            return handler(request);
        } catch (const Error& error) {
            return text_response(error.code() == ExitCode::kUsage ? 400 : 500, error.what());
        } catch (const std::exception& error) {
            return text_response(500, error.what());
        }
    }

    [[nodiscard]] MHD_Result send(MHD_Connection* connection, const Response& response) const {
        MHD_Response* const made = MHD_create_response_from_buffer(
            response.body.size(), const_cast<char*>(response.body.data()), MHD_RESPMEM_MUST_COPY);
        if (made == nullptr) return MHD_NO;
        const std::pair<const char*, const char*> headers[] = {
            {"Cache-Control", "no-store"},
            {"Content-Security-Policy", policy.c_str()},
            {"Cross-Origin-Resource-Policy", "same-origin"},
            {"Referrer-Policy", "no-referrer"},
            {"X-Content-Type-Options", "nosniff"}};
        MHD_add_response_header(made, "Content-Type", response.type.c_str());
        for (const auto& [name, value] : headers) MHD_add_response_header(made, name, value);
        const MHD_Result queued = MHD_queue_response(connection, response.status, made);
        MHD_destroy_response(made);
        return queued;
    }

    static MHD_Result on_request(void* self, MHD_Connection* connection, const char* url, const char* method,
                                 const char*, const char* upload, std::size_t* upload_bytes, void** kept) {
        return guarded([&] {
            const Impl& server = *static_cast<const Impl*>(self);
            if (*kept == nullptr) {
                if (const auto refused = server.refusal(connection, url, method))
                    return server.send(connection, *refused);
                *kept = new Body;
                return MHD_YES;
            }
            auto& body = *static_cast<Body*>(*kept);
            if (*upload_bytes == 0)
                return server.send(connection, server.answer(connection, url, method, body));
            body.is_too_long = body.is_too_long || body.text.size() + *upload_bytes > kMaxBodyBytes;
            if (!body.is_too_long) body.text.append(upload, *upload_bytes);
            *upload_bytes = 0;
            return MHD_YES;
        });
    }
};

namespace {

/// The place that a server listens at.
struct ListenPlace {
    sockaddr_in v4{};
    sockaddr_in6 v6{};
    bool is_v6 = false;
    bool is_all = false;    ///< all addresses of this machine
    bool is_local = false;  ///< this machine alone reaches it

    explicit ListenPlace(const ServerDef& def) {
        v4.sin_family = AF_INET;
        v4.sin_port = htons(def.port);
        v6.sin6_family = AF_INET6;
        v6.sin6_port = htons(def.port);
        constexpr std::uint32_t kLoopback = 127;
        if (::inet_pton(AF_INET, def.bind.c_str(), &v4.sin_addr) == 1) {
            is_all = v4.sin_addr.s_addr == INADDR_ANY;
            is_local = ntohl(v4.sin_addr.s_addr) >> 24U == kLoopback;
        } else if (::inet_pton(AF_INET6, def.bind.c_str(), &v6.sin6_addr) == 1) {
            is_v6 = true;
            is_all = IN6_IS_ADDR_UNSPECIFIED(&v6.sin6_addr);
            is_local = IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr);
        } else {
            throw_usage("--bind {}: is no IPv4 or IPv6 address, such as 0.0.0.0", printable(def.bind));
        }
    }

    /// The address as the host of a URL.
    [[nodiscard]] std::string host(const ServerDef& def) const {
        if (is_all) return is_v6 ? "[::1]" : "127.0.0.1";
        return is_v6 ? fmt::format("[{}]", def.bind) : def.bind;
    }
};

/// "hub.example.org", "10.0.0.2", "[fe80::1]", each with or without a port.
bool is_host(std::string_view text) {
    const auto fits = [](unsigned char c) {
        return c < 128 && (std::isalnum(c) ||
                           std::string_view(".-_:[]").find(static_cast<char>(c)) != std::string_view::npos);
    };
    return !name_of(text).empty() && std::ranges::all_of(text, fits);
}

/// Pages of these hosts may have the page in a frame, whatever their port.
std::string policy_for(std::span<const std::string> hosts) {
    std::string policy =
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'self'";
    for (const std::string& host : hosts)
        if (const std::string name = name_of(host); !name.starts_with('['))  // the grammar has no IPv6
            policy += fmt::format(" http://{0}:* https://{0}:*", name);
    return policy;
}

}  // namespace

Server::Server(const ServerDef& def, Handler handler) : impl_(std::make_unique<Impl>()) {
    impl_->def = def;
    impl_->handler = std::move(handler);
    ListenPlace place(def);
    for (const std::string& host : def.hosts)
        if (!is_host(host)) throw_usage("--host {}: is no name such as hub.example.org", printable(host));
    if (!def.token.empty() && !is_token(def.token))
        throw_usage(
            "--token: {} bytes are not 16 to {} letters, digits, - and _; give such a text, or leave it out",
            def.token.size(), kMaxTokenBytes);
    impl_->policy = policy_for(def.hosts);
    for (const std::string& host : def.hosts)
        if (!place.is_local) impl_->names.push_back(name_of(host));
    if (!place.is_all) impl_->def.hosts.push_back(place.host(def));
    constexpr unsigned kMaxConnections = 64;
    constexpr unsigned kSilentSeconds = 60;
    errno = 0;
    sockaddr* const at =
        place.is_v6 ? reinterpret_cast<sockaddr*>(&place.v6) : reinterpret_cast<sockaddr*>(&place.v4);
    impl_->token = def.token.empty() ? token_of_port(def.port) : def.token;
    impl_->daemon =
        MHD_start_daemon(MHD_USE_THREAD_PER_CONNECTION | MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_AUTO |
                             (place.is_v6 ? static_cast<unsigned>(MHD_USE_IPv6) : 0U),
                         def.port, nullptr, nullptr, &Impl::on_request, impl_.get(), MHD_OPTION_SOCK_ADDR, at,
                         MHD_OPTION_CONNECTION_LIMIT, kMaxConnections, MHD_OPTION_CONNECTION_TIMEOUT,
                         kSilentSeconds, MHD_OPTION_NOTIFY_COMPLETED, &free_body, nullptr, MHD_OPTION_END);
    if (impl_->daemon == nullptr)
        throw_error(ExitCode::kIo, "cannot serve at {}:{}: {}; give another --port, or none", def.bind,
                    def.port, std::generic_category().message(errno));
    const MHD_DaemonInfo* const info = MHD_get_daemon_info(impl_->daemon, MHD_DAEMON_INFO_BIND_PORT);
    impl_->end_of_address = fmt::format(":{}/{}/", info == nullptr ? def.port : info->port, impl_->token);
    impl_->address = fmt::format("http://{}{}", place.host(def), impl_->end_of_address);
}

Server::~Server() {
    MHD_stop_daemon(impl_->daemon);
}

const std::string& Server::address() const {
    return impl_->address;
}

std::vector<std::string> Server::other_addresses() const {
    std::vector<std::string> all;
    for (const std::string& name : impl_->names)
        all.push_back(fmt::format("http://{}{}", name, impl_->end_of_address));
    return all;
}

}  // namespace corda::serve
