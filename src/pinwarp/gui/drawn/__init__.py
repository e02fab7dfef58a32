"""What VTK draws."""
