// What every test program includes, compiled once: see CMakeLists.txt.
int main() {}
