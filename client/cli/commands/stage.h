// What bake and drag have in common: a mesh with compiled handles on a server, the pictures of its
// frames, and how long a change of the handles took.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arap/client/client.h"
#include "client/cli/commands/commands.h"
#include "client/cli/commands/own_words.h"
#include "client/cli/connect/connection.h"
#include "core/drawing/reel.h"
#include "core/files/json_text.h"
#include "core/files/surface_file.h"
#include "core/files/track.h"

namespace arap::cli {

struct StageOptions {
  ServerFlags server;
  std::string mesh;
  std::string track;
  std::string out;         // shapes.csv, or empty
  std::string svg;         // animation, or empty
  std::string frames_svg;  // contact sheet, or empty
  EnergyOptions energy;
  RepairOptions repairs;
  DeformOptions deform;
  Timeout timeout;
  bool as_published = false;
  bool hard = false;
};

void AddStageOptions(CLI::App& command, StageOptions& options, bool out_required);

// The handle set that Open compiles.
inline constexpr const char* kHandleSet = "track";

// Owns a session on the server and deletes it at the end.
class Stage {
 public:
  // Reads both files, connects, registers the mesh and compiles the handles. Prints the warnings of
  // reading and of the server.
  static Result<Stage> Open(const StageOptions& options);

  Stage(Stage&&) = default;
  Stage& operator=(Stage&&) = delete;
  ~Stage();

  const client::Session& session() const { return *session_; }
  const PlanarMesh& mesh() const { return mesh_; }
  const Track& track() const { return track_; }
  // How the file of the mesh counts.
  Counting counting() const { return CountingOf(*mesh_file_); }
  // Where a request to deform comes from: the mesh, and the track with line and column.
  std::vector<Origin> Origins() const;
  // Where a field comes from that is the part of the track to which `steps` lead; entries of the
  // field are `shift` further on in the track.
  Origin InTrack(std::string field, std::string entry, std::vector<JsonStep> steps,
                 std::size_t shift = 0) const;

  double register_micros() const { return register_micros_; }
  double compile_micros() const { return compile_micros_; }

 private:
  Stage(const StageOptions& options, Connection connection, client::Session session,
        SurfaceFile mesh_file, PlanarMesh mesh, Track track, std::string track_text);

  // Deletes the session on the server too.
  struct Release {
    void operator()(const client::Session* session) const;
  };

  Connection connection_;
  std::unique_ptr<const client::Session, Release> session_;
  std::string mesh_name_, track_name_;
  PlanarMesh mesh_;
  Track track_;
  // They stay where they are when this is moved.
  std::unique_ptr<const SurfaceFile> mesh_file_;  // without its mesh
  std::unique_ptr<const std::string> track_text_;
  double register_micros_ = 0;
  double compile_micros_ = 0;
};

// Collects what the pictures need, if any is wanted: some frames, however long the track is.
class FilmMaker {
 public:
  // `every`: whether all frames of the track will come.
  FilmMaker(const StageOptions& options, const Stage& stage, bool every);

  // Frames in their order.
  void Add(std::size_t frame, std::vector<Complex> positions);
  // Writes the pictures that were asked for.
  Status Write(const std::string& caption);

 private:
  // Every handle that the track ever has; NaN where it is not there.
  std::vector<Complex> HandlesAt(std::size_t frame);

  std::string svg_;
  std::string frames_svg_;
  const Track& track_;
  TrackSegments segments_;
  std::size_t handle_count_ = 0;  // that the track ever has
  Reel reel_;
};

// What shapes say of their flips, those that were measured.
struct Flips {
  std::size_t frames = 0;
  std::size_t measured = 0;
  std::size_t with_flips = 0;
  std::size_t most = 0;  // in one frame

  void Add(const client::ShapeQuality& quality);
  // Whether there is anything to say.
  bool are_told() const { return measured > 0 || frames == 0; }
};

// "2 frames with flips", "2 frames with flips of 12 measured", "flips not measured".
std::string Describe(const Flips& flips);

// How long a change of the handles took.
struct EditTimes {
  std::size_t frame = 0;  // done before this one
  std::size_t removed = 0;
  std::size_t added = 0;
  double queue_micros = 0;
  double solve_micros = 0;
  double round_trip_micros = 0;  // 0: not taken
};

// "edit before frame 60: 1 removed, 2 added in 83 µs".
std::string Describe(const EditTimes& times);

}  // namespace arap::cli
