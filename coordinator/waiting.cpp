// SPDX-License-Identifier: Apache-2.0
#include "coordinator/waiting.h"

#include <algorithm>
#include <cassert>

namespace tessera {
namespace {

using book::Band;
using book::Flow;
using book::Lane;
using book::LaneKey;
using book::Line;
using book::LineKey;
using book::Shelf;
using book::Terms;

book::Task& head_of(const Lane& lane) { return *std::get<2>(*lane.lines.begin())->tasks.begin()->second; }
LaneKey key_of(Lane& lane) { return {lane.flow->tag, lane.flow->number, &lane}; }
LineKey key_of(Line& line) { return {line.job->standing.rank, line.head, &line}; }

// Within a flow, then between flows.
bool sooner_in_flow(const Lane& a, const Lane& b) { return *a.lines.begin() < *b.lines.begin(); }
bool sooner(const Lane& a, const Lane& b) {
  if (a.flow == b.flow) return sooner_in_flow(a, b);
  return std::tie(a.flow->tag, a.flow->number) < std::tie(b.flow->tag, b.flow->number);
}

Terms terms_for(const Line& line) {
  Terms terms = line.terms;
  if (line.filter && !terms.device_class) terms.device_class = line.job->filter_class;
  return terms;
}

std::pair<bool, Terms> line_of(const book::Task& task) {
  std::pair<bool, Terms> key{task.filter, book::terms_of(task)};
  key.second.device_class = task.only;
  return key;
}

}  // namespace

void Waiting::add(Task& task) {
  assert(!task.line);
  book::Job& job = *task.job;
  const auto [it, fresh] = job.lines.try_emplace(line_of(task));
  Line& line = it->second;
  if (fresh) {
    line.job = &job;
    line.filter = it->first.first;
    line.terms = it->first.second;
  }
  task.line = &line;
  line.tasks.emplace_hint(line.tasks.end(), task.order, &task);
  if (!line.lane) return list(line);
  if (line.head <= task.order) return;
  unshelve(*line.lane);
  line.lane->lines.erase(key_of(line));
  line.head = task.order;
  line.lane->lines.insert(key_of(line));
  shelve(*line.lane);
}

void Waiting::remove(Task& task) {
  Line& line = *task.line;
  Lane* lane = line.lane;
  if (lane) unshelve(*lane);
  Flow* flow = lane ? lane->flow : nullptr;
  pull(task, line);
  if (flow) tidy(*flow);
}

void Waiting::give(Task& task) {
  Line& line = *task.line;
  if (!line.lane) return remove(task);
  Flow& flow = *line.lane->flow;
  for (auto& [shelf, lane] : flow.lanes) unshelve(lane);
  flow.tag = std::max(flow.tag, flow.band->now) + task.cost;
  pull(task, line);
  tidy(flow);
}

void Waiting::unlist(Job& job) {
  for (auto& [key, line] : job.lines)
    if (line.lane) unlist(line);
}

void Waiting::list(Job& job) {
  for (auto& [key, line] : job.lines)
    if (!line.lane) list(line);
}

// The task leaves its line, which takes its new place in its lane; the lane is not listed meanwhile.
void Waiting::pull(Task& task, Line& line) {
  assert(!line.lane || !line.lane->shelved);
  task.line = nullptr;
  line.tasks.erase(task.order);
  if (line.lane && line.head == task.order) {
    line.lane->lines.erase(key_of(line));
    if (line.tasks.empty()) {
      line.lane = nullptr;
    } else {
      line.head = line.tasks.begin()->first;
      line.lane->lines.insert(key_of(line));
    }
  }
  if (line.tasks.empty() && !line.terms.plain()) line.job->lines.erase({line.filter, Terms(line.terms)});
}

void Waiting::list(Line& line) {
  if (line.tasks.empty() || line.job->paused) return;
  Band& band = bands_[line.job->standing.band];
  band.number = line.job->standing.band;
  Flow& flow = flow_of(band, line.job->standing.flow);
  const Terms terms = terms_for(line);
  Shelf& shelf = band.shelves[terms];
  shelf.band = &band;
  shelf.terms = terms;
  Lane& lane = flow.lanes[&shelf];
  lane.flow = &flow;
  lane.shelf = &shelf;
  unshelve(lane);
  line.lane = &lane;
  line.head = line.tasks.begin()->first;
  lane.lines.insert(key_of(line));
  shelve(lane);
}

void Waiting::unlist(Line& line) {
  Lane& lane = *line.lane;
  Flow& flow = *lane.flow;
  unshelve(lane);
  lane.lines.erase(key_of(line));
  line.lane = nullptr;
  tidy(flow);
}

Flow& Waiting::flow_of(Band& band, const std::string& name) {
  const auto [it, fresh] = band.flows.try_emplace(name);
  Flow& flow = it->second;
  if (fresh) {
    flow.band = &band;
    flow.name = name;
    flow.number = flows_++;
    flow.tag = band.now;
  } else if (flow.idle) {
    band.idle.erase({flow.tag, &flow});
    flow.idle = false;
    flow.tag = std::max(flow.tag, band.now);
  }
  return flow;
}

void Waiting::shelve(Lane& lane) {
  lane.shelved = true;
  lane.tag = lane.flow->tag;
  lane.scene = head_of(lane).scene;
  lane.shelf->lanes.insert(key_of(lane));
  if (lane.scene) lane.shelf->by_scene[lane.scene].insert(key_of(lane));
}

void Waiting::unshelve(Lane& lane) {
  if (!lane.shelved) return;
  lane.shelved = false;
  const LaneKey key{lane.tag, lane.flow->number, &lane};
  lane.shelf->lanes.erase(key);
  if (!lane.scene) return;
  const auto it = lane.shelf->by_scene.find(lane.scene);
  it->second.erase(key);
  if (it->second.empty()) lane.shelf->by_scene.erase(it);
}

// Lists the lanes of the flow that are not; drops what is empty: lanes, the flow, the band.
void Waiting::tidy(Flow& flow) {
  Band& band = *flow.band;
  for (auto it = flow.lanes.begin(); it != flow.lanes.end();) {
    Lane& lane = it->second;
    if (!lane.lines.empty()) {
      if (!lane.shelved) shelve(lane);
      ++it;
      continue;
    }
    if (lane.shelf->lanes.empty()) band.shelves.erase(Terms(lane.shelf->terms));
    it = flow.lanes.erase(it);
  }
  if (band.shelves.empty()) {
    bands_.erase(band.number);
    return;
  }
  if (flow.lanes.empty()) {
    flow.idle = true;
    band.idle.insert({flow.tag, &flow});
  }
  while (!band.idle.empty() && band.idle.begin()->first <= band.now) {
    const Flow* past = band.idle.begin()->second;
    band.idle.erase(band.idle.begin());
    band.flows.erase(std::string(past->name));
  }
}

book::Task* Waiting::first_for(const book::Worker& worker) {
  for (auto& [number, band] : bands_)
    if (Lane* lane = first_lane(band, worker)) return &head_of(*lane);
  return nullptr;
}

Lane* Waiting::first_lane(Band& band, const book::Worker& worker) {
  Lane* first = nullptr;
  for (auto& [terms, shelf] : band.shelves) {
    if (!roster_.may_have(worker, terms)) continue;
    Lane* lane = std::get<2>(*shelf.lanes.begin());
    if (!first || sooner(*lane, *first)) first = lane;
  }
  if (!first) return nullptr;
  band.now = std::max(band.now, first->flow->tag);
  const std::uint64_t scene = head_of(*first).scene;
  if (scene == 0 || std::ranges::find(worker.scenes, scene) != worker.scenes.end()) return first;
  Lane* warm = warm_lane(band, worker, first->flow->tag + slack_);
  return warm ? first_of(*warm->flow, worker) : first;
}

Lane* Waiting::warm_lane(Band& band, const book::Worker& worker, double tag_limit) {
  Lane* warm = nullptr;
  for (auto& [terms, shelf] : band.shelves) {
    if (!roster_.may_have(worker, terms)) continue;
    for (const std::uint64_t scene : worker.scenes) {
      const auto found = scene ? shelf.by_scene.find(scene) : shelf.by_scene.end();
      if (found == shelf.by_scene.end()) continue;
      Lane* lane = std::get<2>(*found->second.begin());
      if (lane->flow->tag <= tag_limit && (!warm || sooner(*lane, *warm))) warm = lane;
    }
  }
  return warm;
}

Lane* Waiting::first_of(Flow& flow, const book::Worker& worker) {
  Lane* first = nullptr;
  for (auto& [shelf, lane] : flow.lanes)
    if (roster_.may_have(worker, shelf->terms) && (!first || sooner_in_flow(lane, *first))) first = &lane;
  return first;
}

bool Waiting::special(const book::DeviceClass& kind) const {
  for (const auto& [number, band] : bands_)
    for (const auto& [terms, shelf] : band.shelves)
      if (!terms.plain() && (!terms.device_class || terms.device_class == &kind)) return true;
  return false;
}

}  // namespace tessera
