"""Read XLSX as a stream, within a budget of work: sheets, cells, formats and shared texts."""
