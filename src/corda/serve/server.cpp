#include "corda/serve/server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <exception>
#include <optional>
#include <system_error>
#include <utility>

#include "corda/core/text.hpp"

namespace corda::serve {
namespace {

constexpr std::size_t kMaxBodyBytes = std::size_t{1} << 20;

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

struct Server::Impl {
    ServerDef def;
    Handler handler;
    std::string token = random_token();
    std::string address;
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

    [[nodiscard]] static MHD_Result send(MHD_Connection* connection, const Response& response) {
        MHD_Response* const made = MHD_create_response_from_buffer(
            response.body.size(), const_cast<char*>(response.body.data()), MHD_RESPMEM_MUST_COPY);
        if (made == nullptr) return MHD_NO;
        constexpr std::pair<const char*, const char*> kHeaders[] = {
            {"Cache-Control", "no-store"},
            {"Content-Security-Policy",
             "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src "
             "'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"},
            {"Cross-Origin-Resource-Policy", "same-origin"},
            {"Referrer-Policy", "no-referrer"},
            {"X-Content-Type-Options", "nosniff"}};
        MHD_add_response_header(made, "Content-Type", response.type.c_str());
        for (const auto& [name, value] : kHeaders) MHD_add_response_header(made, name, value);
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
                    return send(connection, *refused);
                *kept = new Body;
                return MHD_YES;
            }
            auto& body = *static_cast<Body*>(*kept);
            if (*upload_bytes == 0) return send(connection, server.answer(connection, url, method, body));
            body.is_too_long = body.is_too_long || body.text.size() + *upload_bytes > kMaxBodyBytes;
            if (!body.is_too_long) body.text.append(upload, *upload_bytes);
            *upload_bytes = 0;
            return MHD_YES;
        });
    }
};

Server::Server(const ServerDef& def, Handler handler) : impl_(std::make_unique<Impl>()) {
    impl_->def = def;
    impl_->handler = std::move(handler);
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(def.port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    constexpr unsigned kMaxConnections = 64;
    constexpr unsigned kSilentSeconds = 60;
    errno = 0;
    impl_->daemon = MHD_start_daemon(
        MHD_USE_THREAD_PER_CONNECTION | MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_AUTO, def.port, nullptr,
        nullptr, &Impl::on_request, impl_.get(), MHD_OPTION_SOCK_ADDR, reinterpret_cast<sockaddr*>(&place),
        MHD_OPTION_CONNECTION_LIMIT, kMaxConnections, MHD_OPTION_CONNECTION_TIMEOUT, kSilentSeconds,
        MHD_OPTION_NOTIFY_COMPLETED, &free_body, nullptr, MHD_OPTION_END);
    if (impl_->daemon == nullptr)
        throw_error(ExitCode::kIo, "cannot serve at 127.0.0.1:{}: {}; give another --port, or none", def.port,
                    std::generic_category().message(errno));
    const MHD_DaemonInfo* const info = MHD_get_daemon_info(impl_->daemon, MHD_DAEMON_INFO_BIND_PORT);
    impl_->address =
        fmt::format("http://127.0.0.1:{}/{}/", info == nullptr ? def.port : info->port, impl_->token);
}

Server::~Server() {
    MHD_stop_daemon(impl_->daemon);
}

const std::string& Server::address() const {
    return impl_->address;
}

}  // namespace corda::serve
