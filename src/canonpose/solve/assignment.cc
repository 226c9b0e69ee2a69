#include "canonpose/solve/assignment.h"

#include <cstddef>
#include <limits>

namespace canonpose {
namespace {

/// The Hungarian method with potentials: rows are added one by one, each along the shortest augmenting path. Rows and
/// columns count from 1; column 0 stands for the row that is being added.
class Assignment {
 public:
  Assignment(const std::vector<std::vector<double>>& costs, double alone)
      : costs_(costs),
        alone_(alone),
        rows_(costs.size()),
        real_columns_(costs.empty() ? 0 : costs.front().size()),
        columns_(real_columns_ + rows_),
        row_potential_(rows_ + 1, 0.0),
        column_potential_(columns_ + 1, 0.0),
        row_of_(columns_ + 1, 0),
        previous_(columns_ + 1, 0) {}

  std::vector<int> Solve() {
    for (std::size_t row = 1; row <= rows_; ++row) AddRow(row);
    std::vector<int> column_of(rows_, -1);
    for (std::size_t column = 1; column <= real_columns_; ++column) {
      if (row_of_[column] > 0) column_of[row_of_[column] - 1] = static_cast<int>(column) - 1;
    }
    return column_of;
  }

 private:
  /// Every row has a column of its own in which it is alone.
  [[nodiscard]] double Cost(std::size_t row, std::size_t column) const {
    return column <= real_columns_ ? costs_[row - 1][column - 1] : alone_;
  }

  void AddRow(std::size_t row) {
    row_of_[0] = row;
    std::vector<double> least(columns_ + 1, std::numeric_limits<double>::infinity());
    std::vector<bool> is_used(columns_ + 1, false);
    std::size_t column = 0;
    do {
      column = Step(column, least, is_used);
    } while (row_of_[column] != 0);
    while (column != 0) {
      row_of_[column] = row_of_[previous_[column]];
      column = previous_[column];
    }
  }

  /// Takes `column` into the tree of paths, and returns the nearest one outside of it.
  std::size_t Step(std::size_t column, std::vector<double>& least, std::vector<bool>& is_used) {
    is_used[column] = true;
    const std::size_t row = row_of_[column];
    double delta = std::numeric_limits<double>::infinity();
    std::size_t next = 0;
    for (std::size_t other = 1; other <= columns_; ++other) {
      if (is_used[other]) continue;
      const double reduced = Cost(row, other) - row_potential_[row] - column_potential_[other];
      if (reduced < least[other]) {
        least[other] = reduced;
        previous_[other] = column;
      }
      if (least[other] < delta) {
        delta = least[other];
        next = other;
      }
    }
    for (std::size_t other = 0; other <= columns_; ++other) {
      if (is_used[other]) {
        row_potential_[row_of_[other]] += delta;
        column_potential_[other] -= delta;
      } else {
        least[other] -= delta;
      }
    }
    return next;
  }

  const std::vector<std::vector<double>>& costs_;
  double alone_;
  std::size_t rows_;
  std::size_t real_columns_;
  std::size_t columns_;
  std::vector<double> row_potential_;
  std::vector<double> column_potential_;
  std::vector<std::size_t> row_of_;    ///< of each column; 0: none
  std::vector<std::size_t> previous_;  ///< the column before on the path
};

}  // namespace

std::vector<int> AssignAtLeastCost(const std::vector<std::vector<double>>& costs, double alone) {
  return Assignment(costs, alone).Solve();
}

}  // namespace canonpose
