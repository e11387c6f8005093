#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/golden/suite.hpp"
#include "corda/serve/server.hpp"

namespace corda::serve {

/// The failed pictures of a golden suite for a page on which a person accepts or rejects each. Nothing is
/// written before the page asks for it.
class Review {
  public:
    /// `def` is what `result` was made with; its folder of new pictures holds those that can be accepted.
    Review(golden::SuiteDef def, const golden::SuiteResult& result);

    /// Answers a request of the page:
    ///   "", "style.css", "review.js"      the page
    ///   "pictures"                        JSON: the pictures to decide on, with cause and group
    ///   "picture/I/KIND.png"              of picture I: reference, new or difference
    ///   POST "mark" {"marks": {name: M}}  marks pictures by "accept", "reject" or ""; a page that is opened
    ///                                     again shows the marks
    ///   POST "apply" {"accept": [names]}  keeps these pictures as golden::accept() does
    ///   POST "end"                        ends wait()
    [[nodiscard]] Response answer(const Request& request);

    /// Waits until the page has ended, or for `timeout_ms`. True if it has.
    [[nodiscard]] bool wait(int timeout_ms);

    /// The number of pictures that were not accepted.
    [[nodiscard]] std::size_t open_count() const;
    [[nodiscard]] std::size_t accepted_count() const;

  private:
    [[nodiscard]] Response picture(std::string_view path) const;
    [[nodiscard]] Response mark(const nlohmann::json& marks);
    [[nodiscard]] Response apply(const std::vector<std::string>& names);

    golden::SuiteDef def_;
    std::vector<golden::Checked> pictures_;
    mutable std::mutex mutex_;
    std::condition_variable ended_;
    std::set<std::string> accepted_;
    std::map<std::string, std::string> marks_;  ///< of pictures by their names
    bool has_ended_ = false;
};

}  // namespace corda::serve
