#include "corda/serve/server.hpp"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <system_error>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"

namespace corda::serve {
namespace {

constexpr std::size_t kMaxBodyBytes = std::size_t{1} << 20;

/// The functions of libmicrohttpd, which is loaded on first use: with the nine libraries that it brings, it
/// would take 3.6 ms of each start of the program.
class Library {
  public:
    static const Library& get() {
        static const Library library;
        return library;
    }

    decltype(&MHD_start_daemon) start_daemon = nullptr;
    decltype(&MHD_stop_daemon) stop_daemon = nullptr;
    decltype(&MHD_get_daemon_info) get_daemon_info = nullptr;
    decltype(&MHD_get_connection_values) get_connection_values = nullptr;
    decltype(&MHD_lookup_connection_value) lookup_connection_value = nullptr;
    decltype(&MHD_create_response_from_buffer) create_response_from_buffer = nullptr;
    decltype(&MHD_add_response_header) add_response_header = nullptr;
    decltype(&MHD_queue_response) queue_response = nullptr;
    decltype(&MHD_destroy_response) destroy_response = nullptr;

  private:
    Library() : handle_(dlopen("libmicrohttpd.so.12", RTLD_NOW | RTLD_LOCAL)) {
        if (handle_ == nullptr) fail();
        find(start_daemon, "MHD_start_daemon");
        find(stop_daemon, "MHD_stop_daemon");
        find(get_daemon_info, "MHD_get_daemon_info");
        find(get_connection_values, "MHD_get_connection_values");
        find(lookup_connection_value, "MHD_lookup_connection_value");
        find(create_response_from_buffer, "MHD_create_response_from_buffer");
        find(add_response_header, "MHD_add_response_header");
        find(queue_response, "MHD_queue_response");
        find(destroy_response, "MHD_destroy_response");
    }

    template <class Function>
    void find(Function& function, const char* name) {
        function = reinterpret_cast<Function>(dlsym(handle_, name));
        if (function == nullptr) fail();
    }

    [[noreturn]] static void fail() {
        throw Error(ExitCode::kTemporary,
                    fmt::format("the web server cannot be loaded: {}; install it (Debian: apt-get install "
                                "libmicrohttpd12)",
                                dlerror()));
    }

    void* handle_;
};

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

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

MHD_Result add_value(void* values, MHD_ValueKind, const char* name, const char* value) {
    auto& query = *static_cast<decltype(Request::query)*>(values);
    query[name] = value == nullptr ? "" : value;
    return MHD_YES;
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
    const std::size_t end = host.find(':', host.starts_with('[') ? host.find(']') : 0);
    const std::string name = lower(host.substr(0, end));
    if (name == "localhost" || name == "127.0.0.1" || name == "[::1]") return true;
    return std::any_of(others.begin(), others.end(),
                       [&](const std::string& other) { return lower(other) == name; });
}

struct Server::Impl {
    ServerDef def;
    Handler handler;
    std::string token = random_token();
    std::string address;
    MHD_Daemon* daemon = nullptr;

    [[nodiscard]] std::string header(MHD_Connection* connection, const char* name) const {
        const char* const value = Library::get().lookup_connection_value(connection, MHD_HEADER_KIND, name);
        return value == nullptr ? "" : value;
    }

    [[nodiscard]] Response answer(MHD_Connection* connection, std::string_view url, std::string_view method,
                                  Body& body) const {
        const std::string host = header(connection, "Host");
        if (!is_known_host(host, def.hosts))
            return text_response(
                403, fmt::format("'{}' is not this machine; behind a proxy of that name, start with "
                                 "--host {}\n",
                                 printable(host), printable(host.substr(0, host.find(':')))));
        const std::string origin = header(connection, "Origin");
        const std::size_t scheme_end = origin.find("://");
        const std::string_view origin_host =
            scheme_end == std::string::npos ? origin : std::string_view(origin).substr(scheme_end + 3);
        if (!origin.empty() && origin_host != host &&
            !std::any_of(def.hosts.begin(), def.hosts.end(),
                         [&](const std::string& its) { return lower(its) == lower(origin_host); }))
            return text_response(403, "requests of other pages are refused\n");
        if (url.size() < token.size() + 2 || !is_equal(url.substr(1, token.size()), token) ||
            url[token.size() + 1] != '/')
            return text_response(404, "there is no such page; take the address that the program printed\n");
        if (method != "GET" && method != "HEAD" && method != "POST")
            return text_response(405, "the methods are GET and POST\n");
        if (body.is_too_long) return text_response(413, "the request is too long\n");
        Request request;
        request.is_post = method == "POST";
        request.path = url.substr(token.size() + 2);
        request.body = std::move(body.text);
        Library::get().get_connection_values(connection, MHD_GET_ARGUMENT_KIND, &add_value, &request.query);
        try {
            return handler(request);
        } catch (const Error& error) {
            return text_response(error.code() == ExitCode::kUsage ? 400 : 500, error.what());
        } catch (const std::exception& error) {
            return text_response(500, error.what());
        }
    }

    [[nodiscard]] static MHD_Result send(MHD_Connection* connection, const Response& response) {
        const Library& library = Library::get();
        MHD_Response* const made = library.create_response_from_buffer(
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
        library.add_response_header(made, "Content-Type", response.type.c_str());
        for (const auto& [name, value] : kHeaders) library.add_response_header(made, name, value);
        const MHD_Result queued = library.queue_response(connection, response.status, made);
        library.destroy_response(made);
        return queued;
    }

    static MHD_Result on_request(void* self, MHD_Connection* connection, const char* url, const char* method,
                                 const char*, const char* upload, std::size_t* upload_bytes, void** kept) {
        if (*kept == nullptr) {
            *kept = new Body;
            return MHD_YES;
        }
        auto& body = *static_cast<Body*>(*kept);
        if (*upload_bytes > 0) {
            body.is_too_long = body.is_too_long || body.text.size() + *upload_bytes > kMaxBodyBytes;
            if (!body.is_too_long) body.text.append(upload, *upload_bytes);
            *upload_bytes = 0;
            return MHD_YES;
        }
        return send(connection, static_cast<const Impl*>(self)->answer(connection, url, method, body));
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
    const Library& library = Library::get();
    errno = 0;
    impl_->daemon = library.start_daemon(
        MHD_USE_THREAD_PER_CONNECTION | MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_AUTO, def.port, nullptr,
        nullptr, &Impl::on_request, impl_.get(), MHD_OPTION_SOCK_ADDR, reinterpret_cast<sockaddr*>(&place),
        MHD_OPTION_CONNECTION_LIMIT, kMaxConnections, MHD_OPTION_CONNECTION_TIMEOUT, kSilentSeconds,
        MHD_OPTION_NOTIFY_COMPLETED, &free_body, nullptr, MHD_OPTION_END);
    if (impl_->daemon == nullptr)
        throw Error(ExitCode::kIo,
                    fmt::format("cannot serve at 127.0.0.1:{}: {}; give another --port, or none", def.port,
                                std::generic_category().message(errno)));
    const MHD_DaemonInfo* const info = library.get_daemon_info(impl_->daemon, MHD_DAEMON_INFO_BIND_PORT);
    impl_->address =
        fmt::format("http://127.0.0.1:{}/{}/", info == nullptr ? def.port : info->port, impl_->token);
}

Server::~Server() {
    Library::get().stop_daemon(impl_->daemon);
}

const std::string& Server::address() const {
    return impl_->address;
}

}  // namespace corda::serve
