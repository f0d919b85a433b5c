"""The energy as a finite Fourier series: the certificate of exact balance."""
