// SPDX-License-Identifier: MIT
#include <surfleet/allocation/tsplib.hpp>

#include <filesystem>
#include <string>

#include <surfleet/allocation/exact_tour.hpp>
#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
std::string message_of(const std::string& text) {
  try {
    parse_tsplib(text, "file");
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}
std::string explicit_file(const std::string& format, const std::string& weights) {
  return "NAME: x\nTYPE: TSP\nDIMENSION: 4\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: " +
         format + "\nEDGE_WEIGHT_SECTION\n" + weights + "\nEOF\n";
}
}  // namespace

TEST(tsplib_geographical_distances_give_the_known_optimum) {
  // burma14 of TSPLIB, optimum 3323.
  const std::string text =
      "NAME: burma14\nTYPE: TSP\nCOMMENT: 14-Staedte in Burma (Zaw Win)\nDIMENSION: 14\n"
      "EDGE_WEIGHT_TYPE: GEO\nEDGE_WEIGHT_FORMAT: FUNCTION\nDISPLAY_DATA_TYPE: COORD_DISPLAY\n"
      "NODE_COORD_SECTION\n"
      " 1 16.47 96.10\n 2 16.47 94.44\n 3 20.09 92.54\n 4 22.39 93.37\n 5 25.23 97.24\n"
      " 6 22.00 96.05\n 7 20.47 97.02\n 8 17.20 96.29\n 9 16.30 97.38\n 10 14.05 98.12\n"
      " 11 16.53 97.38\n 12 21.52 95.59\n 13 19.41 97.13\n 14 20.09 94.55\nEOF\n";
  const TsplibInstance instance = parse_tsplib(text);
  CHECK(instance.name == "burma14" && !instance.asymmetric && instance.costs.symmetric());
  CHECK(ExactTour{}(TourProblem{instance.costs}).length == 3323.0);
  CHECK(instance.coordinates.size() == 14);
}

TEST(tsplib_plane_distances_round_as_defined) {
  const auto distance = [](const std::string& type) {
    return parse_tsplib("DIMENSION : 3\nEDGE_WEIGHT_TYPE : " + type +
                        "\nNODE_COORD_SECTION\n2 10 0\n1 0 0\n3 +1e0 1.0\n")
        .costs;
  };
  CHECK(distance("EUC_2D")(0, 2) == 1.0 && distance("EUC_2D")(0, 1) == 10.0);
  CHECK(distance("CEIL_2D")(0, 2) == 2.0 && distance("CEIL_2D")(0, 1) == 10.0);
  // sqrt(100 / 10) = 3.16 rounds to 3, which is less: 4.
  CHECK(distance("ATT")(0, 1) == 4.0 && distance("ATT")(0, 2) == 1.0);
}

TEST(tsplib_explicit_formats_agree) {
  const CostMatrix full =
      parse_tsplib(explicit_file("FULL_MATRIX", "0 1 2 3\n1 0 4 5\n2 4 0 6\n3 5 6 0")).costs;
  const std::pair<const char*, const char*> formats[] = {{"UPPER_ROW", "1 2 3 4 5 6"},
                                                         {"LOWER_ROW", "1 2 4 3\n5 6"},
                                                         {"UPPER_DIAG_ROW", "0 1 2 3 0 4 5 0 6 0"},
                                                         {"LOWER_DIAG_ROW", "0 1 0 2 4 0 3 5 6 0"},
                                                         {"UPPER_COL", "1 2 4 3 5 6"},
                                                         {"LOWER_COL", "1 2 3 4 5 6"}};
  for (const auto& [format, weights] : formats) {
    const CostMatrix c = parse_tsplib(explicit_file(format, weights)).costs;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) CHECK(c(i, j) == full(i, j));
  }
}

TEST(tsplib_round_trip) {
  Random random(2);
  TsplibInstance instance;
  instance.name = "random";
  instance.comment = "one\ntwo";
  instance.asymmetric = true;
  instance.costs = CostMatrix(7);
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j) instance.costs(i, j) = i == j ? 1e8 : random.normal();
  const auto path = std::filesystem::temp_directory_path() / "surfleet_tsplib_test.atsp";
  write_tsplib(path, instance);
  const TsplibInstance back = read_tsplib(path);
  std::filesystem::remove(path);
  CHECK(back.name == "random" && back.comment == "one two" && back.asymmetric);
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j) CHECK(back.costs(i, j) == instance.costs(i, j));
  CHECK_THROWS(Error, read_tsplib(path));
}

TEST(tsplib_passes_over_keywords_that_it_does_not_know) {
  const TsplibInstance instance = parse_tsplib(
      "NAME : six\nBEST_KNOWN : 17.5 (proved)\nTYPE: TSP\nSOURCE:\nDIMENSION: 3\nVEHICLES : 2\n"
      "EDGE_WEIGHT_TYPE: EXPLICIT\nSALESMAN: J. Doe: the second\nEDGE_WEIGHT_FORMAT: UPPER_ROW\n"
      "EDGE_WEIGHT_SECTION\n1 2 3\nOPTIMUM: 6\nEOF\n");
  CHECK(instance.name == "six" && instance.costs.size() == 3);
  CHECK(instance.costs(0, 1) == 1.0 && instance.costs(1, 2) == 3.0);
}

TEST(tsplib_refuses_bad_files_in_one_line_with_its_number) {
  const std::pair<std::string, std::string> bad[] = {
      {"", "DIMENSION"},
      {"hello world", "file:1: \"hello\" is not a keyword"},
      {"DIMENSION: 0\n", "file:1: DIMENSION"},
      {"DIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 1 0\nDIMENSION: 400\n",
       "file:6: DIMENSION after the section"},
      {"DIMENSION: 3\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: UPPER_ROW\n"
       "EDGE_WEIGHT_SECTION\n1 2 3\nEDGE_WEIGHT_FORMAT: FULL_MATRIX\n",
       "file:6: EDGE_WEIGHT_FORMAT after the section"},
      {"DIMENSION: -3\n", "DIMENSION"},
      {"NAME: x\nDIMENSION: 99999999999\n", "file:2: DIMENSION"},
      {"DIMENSION: 3x\n", "DIMENSION"},
      {"TYPE: CVRP\n", "TYPE"},
      {"DIMENSION: 3\nEDGE_WEIGHT_TYPE: XRAY1\n", "file:2: EDGE_WEIGHT_TYPE"},
      {"DIMENSION: 3\nEDGE_WEIGHT_TYPE: EUC_2D\n", "NODE_COORD_SECTION"},
      {"DIMENSION: 3\n", "EDGE_WEIGHT_TYPE"},
      {"NODE_COORD_SECTION\n1 2 3\n", "before DIMENSION"},
      {"DIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n", "file ends"},
      {"DIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n1 0 0\n", "twice"},
      {"DIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n3 0 0\n", "file:5:"},
      {"DIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 nan 0\n", "finite"},
      {"DIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 1e300 0\n",
       "overflows"},
      {explicit_file("FULL_MATRIX", "0 1 2"), "\"EOF\" is no edge weight"},
      {explicit_file("FUNCTION", "0 1 2"), "EDGE_WEIGHT_FORMAT"},
      {explicit_file("UPPER_ROW", "0 1 2 3 4 inf"), "finite"},
      {explicit_file("UPPER_ROW", "0 1 2 3 4 5 6"), "not a keyword"},
      {"DIMENSION: 3\nFIXED_EDGES_SECTION\n", "not supported"},
      {"DIMENSION: 3\nBANANA 3\n", "unknown keyword"},
      {": 3\n", "colon"},
      {std::string("DIMENSION: 3\n\0\x01\xff", 16), "not a keyword"}};
  for (const auto& [text, part] : bad) {
    const std::string message = message_of(text);
    check::report(
        message.find(part) != std::string::npos && message.find('\n') == std::string::npos,
        __FILE__, __LINE__, (text + " -> " + message).c_str());
  }
}

TEST(tsplib_accepts_variants_of_layout) {
  CHECK(parse_tsplib("TYPE : ATSP\r\nDIMENSION:2\r\nEDGE_WEIGHT_TYPE :EXPLICIT\r\n"
                     "EDGE_WEIGHT_FORMAT: FULL_MATRIX \r\nEDGE_WEIGHT_SECTION\r\n0 1 2 0\r\nEOF")
            .costs(1, 0) == 2.0);
  CHECK(parse_tsplib("DIMENSION: 1\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n"
                     "DISPLAY_DATA_SECTION\n1 0 0\n")
            .costs.size() == 1);
}
