/// \file
/// Contents of files, cached in memory until the file changes.
#pragma once

#include <lefort/core/error.h>

#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace lefort::server {

/// Cache of the most recently used values, by name and entity tag of the file. Thread-safe; other
/// callers wait while a value is read, so that it is read once.
template <class Value>
class LruCache {
 public:
  explicit LruCache(std::size_t maximum) : max_count_(maximum) {}

  /// \param read  returns Result<Value>.
  template <class Read>
  [[nodiscard]] Result<std::shared_ptr<const Value>> get(const std::string& name,
                                                         const std::string& etag,
                                                         const Read& read) {
    const std::scoped_lock lock(mutex_);
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->name != name) continue;
      if (entry->etag == etag) {
        entries_.splice(entries_.begin(), entries_, entry);
        return entries_.front().value;
      }
      entries_.erase(entry);
      break;
    }
    LEFORT_TRY(Value value, read());
    return add(name, etag, std::move(value));
  }

  /// Replaces the value of this name.
  void put(const std::string& name, const std::string& etag, Value value) {
    const std::scoped_lock lock(mutex_);
    entries_.remove_if([&](const Entry& entry) { return entry.name == name; });
    add(name, etag, std::move(value));
  }

 private:
  struct Entry {
    std::string name, etag;
    std::shared_ptr<const Value> value;
  };
  /// \pre the mutex is locked.
  std::shared_ptr<const Value> add(const std::string& name, const std::string& etag, Value value) {
    auto shared = std::make_shared<const Value>(std::move(value));
    entries_.push_front({name, etag, shared});
    if (entries_.size() > max_count_) entries_.pop_back();
    return shared;
  }

  const std::size_t max_count_;
  std::mutex mutex_;
  std::list<Entry> entries_;
};

}  // namespace lefort::server
