#pragma once

#include <optional>
#include <string>
#include <vector>

#include "corda/core/file.hpp"

namespace corda::golden {

/// The folder inside a folder of golden pictures in which an update stages its changes. A journal makes the
/// changes one: once it is written, they are published, or taken back if one of them fails. If the process is
/// killed in between, settle_update() completes the same.
///
/// The folder is locked while the object lives, and only its owner may open it, so that nobody else can lock
/// it. It contains:
///   corda-golden-update   a marker: without it a folder of this name is not ours, and is left alone
///   new/NAME              pictures that are not published yet
///   old/NAME              pictures that were replaced or removed
///   journal               the names to write and to remove, and an end; named `undo` while the changes are
///                         taken back
class UpdateFolder {
  public:
    /// Makes the folder in `pictures`. Throws corda::Error: kTemporary if another update is at work; kIo,
    /// also if an update was killed here and not settled.
    [[nodiscard]] static UpdateFolder create(const std::string& pictures);

    /// Opens the folder that a killed update has left; none if there is none. Throws as create().
    [[nodiscard]] static std::optional<UpdateFolder> open(const std::string& pictures);

    /// The path under which the new version of a picture is staged.
    [[nodiscard]] std::string staged(const std::string& name) const { return inside_ + "/new/" + name; }

    /// True if changes have begun that are neither complete nor taken back.
    [[nodiscard]] bool has_journal() const;

    /// Replaces `written` by the staged pictures and removes `removed`: file names without folders. Throws
    /// corda::Error (kIo) with all pictures as they were, or saying that they are not.
    void publish(const std::vector<std::string>& written, const std::vector<std::string>& removed);

    /// Completes the journal, or takes it back if that fails. Returns what was done, in words. Throws
    /// corda::Error (kIo).
    [[nodiscard]] std::string settle();

    /// Removes the folder; never throws. A folder with a journal stays.
    void remove() noexcept;

  private:
    struct Change {
        char kind =
            'w';  ///< the letter in the journal: 'w' replaces a picture, 'a' adds one, 'r' removes one
        std::string name;
    };

    UpdateFolder(std::string pictures, std::string inside, Descriptor lock);

    [[nodiscard]] std::string picture(const std::string& name) const { return pictures_ + "/" + name; }
    [[nodiscard]] std::string old(const std::string& name) const { return inside_ + "/old/" + name; }
    [[nodiscard]] std::vector<Change> read_journal(const std::string& name) const;
    void apply(const std::vector<Change>& changes) const;
    void save_old(const Change& change) const;
    [[nodiscard]] bool is_restored(const std::vector<Change>& changes) const;
    void take_back(const std::vector<Change>& changes) const;

    std::string pictures_;
    std::string inside_;
    Descriptor lock_;
};

/// Completes or takes back the changes of an update that was killed, and removes what else it left. Returns
/// what was done, in words; empty if there was nothing to do. With `dry_run` nothing is done, and a journal
/// is an error. Throws corda::Error: kTemporary if another update is publishing; kIo.
[[nodiscard]] std::string settle_update(const std::string& pictures, bool dry_run);

}  // namespace corda::golden
