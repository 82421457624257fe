"""Many cases: result store, sensitivity, comparison."""
