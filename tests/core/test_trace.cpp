#include <lefort/core/trace.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

namespace lefort::test_trace {
namespace {

const TraceEvent& event_of(const std::vector<TraceEvent>& events, const std::string& name) {
  return *std::ranges::find(events, name, &TraceEvent::name);
}

TEST(Trace, NothingIsRecordedWithoutARecord) {
  { const TraceSpan span("before"); }
  record_event("before, too", 0.0);
  start_trace();
  EXPECT_TRUE(stop_trace().empty());
  { const TraceSpan span("after"); }
  EXPECT_TRUE(stop_trace().empty());
}

TEST(Trace, ASpanLiesInTheSpanAroundIt) {
  start_trace();
  {
    const TraceSpan outer("outer");
    const TraceSpan inner("inner");
  }
  const std::vector<TraceEvent> events = stop_trace();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events.front().name, "inner");
  const TraceEvent &outer = event_of(events, "outer"), &inner = event_of(events, "inner");
  EXPECT_LE(outer.begin_us, inner.begin_us);
  EXPECT_GE(outer.begin_us + outer.duration_us, inner.begin_us + inner.duration_us);
  EXPECT_EQ(outer.thread, 0U);
}

TEST(Trace, ThreadsHaveNumbersOfTheirOwn) {
  start_trace();
  std::thread([] { const TraceSpan span("other"); }).join();
  record_event("first", trace_time_us());
  const std::vector<TraceEvent> events = stop_trace();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(event_of(events, "first").thread, 0U);
  EXPECT_EQ(event_of(events, "other").thread, 1U);
}

/// A span of one record does not end in the next one.
TEST(Trace, ANewRecordBeginsAtZero) {
  start_trace();
  record_event("old", 0.0);
  {
    const TraceSpan span("of the old record");
    start_trace();
  }
  record_event("new", trace_time_us());
  const std::vector<TraceEvent> events = stop_trace();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events.front().name, "new");
  EXPECT_GE(events.front().begin_us, 0.0);
}

}  // namespace
}  // namespace lefort::test_trace
