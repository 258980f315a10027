#include "orchestrator/recording/exporters.h"

#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "orchestrator/formats/csv.h"
#include "orchestrator/formats/mat_file.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/recording/states_npz.h"

namespace mascot {
namespace {

bool IsExported(const StateArray& array, const Recording& recording) {
  return recording.has_commands() || !array.of_command;
}

void ForEachStateRow(const Recording& recording, const std::function<void(std::int64_t, const StateRow&)>& on_row) {
  DecodedRow decoded(recording.agents());
  StateRow values(recording.agents());
  recording.ForEachRow([&](const Row& row) {
    try {
      Decode(row, decoded);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(recording.path() + ": " + error.what());
    }
    values.Set(recording.time_s(row.tick), decoded);
    on_row(row.tick, values);
  });
}

void WriteNpz(const Recording& recording, const std::string& path) {
  StatesNpz npz(path, recording.agents(), recording.ticks().rows(), recording.has_commands());
  ForEachStateRow(recording, [&](std::int64_t, const StateRow& row) { npz.Append(row); });
  npz.Close();
}

/// Writes the long ("tidy") form: a line per row and agent.
void WriteCsv(const Recording& recording, const std::string& path) {
  std::vector<std::string> columns = {"t", "id"};
  std::vector<std::size_t> arrays;
  for (std::size_t a = 1; a < kStateArrays.size(); ++a) {
    if (!IsExported(kStateArrays[a], recording)) continue;
    arrays.push_back(a);
    const std::string name(kStateArrays[a].name);
    if (kStateArrays[a].has_one())
      columns.push_back(name);
    else
      for (const char component : kStateArrays[a].components) columns.push_back(name + "_" + component);
  }
  CsvWriter csv(path, columns);
  ForEachStateRow(recording, [&](std::int64_t tick, const StateRow& row) {
    for (int id = 1; id <= recording.agents(); ++id) {
      csv.Add(recording.time_s(tick));
      csv.Add(std::int64_t{id});
      for (const std::size_t a : arrays) {
        const std::size_t width = kStateArrays[a].components.size();
        for (const double value : row.Values(a).subspan(static_cast<std::size_t>(id - 1) * width, width))
          csv.Add(value);
      }
      csv.EndRow();
    }
  });
  csv.Close();
}

/// One array in column-major order, as MATLAB wants it. The first index (rows) runs fastest, so that the whole array
/// must be in memory.
struct Transposed {
  std::size_t array;                    // index into kStateArrays
  std::vector<std::size_t> dimensions;  // rows x N x components, rows x N, or rows x 1
  std::vector<double> values;

  Transposed(std::size_t a, std::size_t rows, std::size_t agents) : array(a), dimensions{rows, 1} {
    const StateArray& of = kStateArrays[a];
    if (!of.components.empty()) dimensions[1] = agents;
    if (of.components.size() > 1) dimensions.push_back(of.components.size());
    MatWriter::RequireFits(std::string(of.name), dimensions);
    values.resize(rows * of.row_values(agents));
  }
  void Take(std::size_t k, const StateRow& row) {
    const std::span<const double> in = row.Values(array);
    const std::size_t rows = dimensions[0], agents = dimensions[1], width = in.size() / agents;
    for (std::size_t i = 0; i < agents; ++i)
      for (std::size_t c = 0; c < width; ++c) values[k + rows * (i + agents * c)] = in[i * width + c];
  }
};

/// Writes a MATLAB file. Needs as much memory as the file has bytes.
void WriteMat(const Recording& recording, const std::string& path) {
  const auto rows = static_cast<std::size_t>(recording.ticks().rows()),
             agents = static_cast<std::size_t>(recording.agents());
  std::vector<Transposed> arrays;
  for (std::size_t a = 0; a < kStateArrays.size(); ++a)
    if (IsExported(kStateArrays[a], recording)) arrays.emplace_back(a, rows, agents);
  std::size_t k = 0;
  ForEachStateRow(recording, [&](std::int64_t, const StateRow& row) {
    for (Transposed& array : arrays) array.Take(k, row);
    ++k;
  });
  MatWriter mat(path);
  mat.AddText("experiment", recording.name());
  mat.AddText("config", recording.config());
  std::vector<double> ids(agents);
  std::iota(ids.begin(), ids.end(), 1.0);
  mat.Add("id", std::vector<std::size_t>{1, agents}, ids);
  for (const Transposed& array : arrays)
    mat.Add(std::string(kStateArrays[array.array].name), array.dimensions, array.values);
  mat.Close();
}

constexpr Exporter kExporters[] = {
    {"npz", WriteNpz},
    {"csv", WriteCsv},
    {"mat", WriteMat},
};

}  // namespace

std::span<const Exporter> Exporters() { return kExporters; }

}  // namespace mascot
